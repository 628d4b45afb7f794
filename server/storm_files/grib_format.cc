#include "storm_files/grib_format.h"

#include <utility>

#include "base/status.h"
#include "grib/decompressed.h"
#include "grib/index.h"
#include "grib/listing.h"
#include "grib/values.h"
#include "storm_files/grib_parts.h"
#include "storm_files/grib_storm.h"

namespace thunderhead::storm_files {
namespace {

class GribFormat final : public StormFormat {
 public:
  std::string_view Name() const override { return "GRIB2"; }
  std::string_view Example() const override { return "GRIB2"; }
  std::string_view Requirement() const override { return "GRIB2 (it has no GRIB message)"; }

  bool MayBegin(std::string_view start) const override {
    // A netCDF file that was made from GRIB names it in attributes.
    if (netcdf::NetcdfFile::BeginsLikeNetcdf(start)) return false;
    return grib::BeginsLikeGrib(start) || grib::BeginsCompressed(start);
  }

  // The listing of a compressed file has offsets in the plain one.
  absl::Status CheckNeighbours(const std::string& path, std::string_view start,
                               std::uint64_t size_bytes) const override {
    if (!grib::BeginsLikeGrib(start)) return absl::OkStatus();
    return grib::CheckListing(path, size_bytes);
  }

  absl::Status PrepareBeforeConfinement() const override {
    return grib::PrepareBeforeConfinement();
  }

  FormatFit Sniff(const UnknownFile& file) const override {
    return MayBegin(file.Start()) ? FormatFit::kModelLayout : FormatFit::kNone;
  }

  absl::StatusOr<StormFile> Describe(const UnknownFile& file) const override {
    THUNDERHEAD_RETURN_IF_ERROR(file.Bytes().status());
    THUNDERHEAD_ASSIGN_OR_RETURN(std::shared_ptr<const grib::Index> index,
                                 IndexOfGrib(*file.Bytes()));
    THUNDERHEAD_ASSIGN_OR_RETURN(GribPart part, GribPartOf(*index));
    if (part.kind == GribPartKind::kWhole) {
      return Together(file.Path(), {GribFileAt(file.Path())}, {std::move(index)});
    }
    StormFile described;
    described.path = file.Path();
    described.about = "Part of a time in GRIB2";
    described.times = std::move(part.times);
    described.part = {std::move(part.of), part.kind == GribPartKind::kInvariant};
    return described;
  }

  absl::StatusOr<StormFile> DescribeTogether(const std::vector<UnknownFile>& files) const override {
    std::vector<GribInput> inputs;
    GribIndexes indexes;
    for (const UnknownFile& file : files) {
      THUNDERHEAD_RETURN_IF_ERROR(file.Bytes().status());
      THUNDERHEAD_ASSIGN_OR_RETURN(indexes.emplace_back(), IndexOfGrib(*file.Bytes()));
      inputs.push_back(GribFileAt(file.Path()));
    }
    return Together(files.front().Path(), std::move(inputs), std::move(indexes));
  }

 private:
  static absl::StatusOr<StormFile> Together(const std::string& path, std::vector<GribInput> files,
                                            GribIndexes indexes) {
    THUNDERHEAD_ASSIGN_OR_RETURN(std::shared_ptr<const GribStorm> storm,
                                 MakeGribStorm(path, std::move(files), std::move(indexes)));
    return DescribeGribStorm(std::move(storm));
  }
};

}  // namespace

std::shared_ptr<const StormFormat> MakeGribFormat() { return std::make_shared<GribFormat>(); }

}  // namespace thunderhead::storm_files
