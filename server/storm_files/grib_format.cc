#include "storm_files/grib_format.h"

#include <utility>

#include "base/status.h"
#include "grib/decompressed.h"
#include "grib/index.h"
#include "grib/listing.h"
#include "grib/values.h"
#include "storm_files/grib_parts.h"
#include "storm_files/grib_storm.h"
#include "storm_files/grib_summary.h"

namespace thunderhead::storm_files {
namespace {

class GribFormat final : public StormFormat {
 public:
  std::string_view Name() const override { return "GRIB2"; }
  std::string_view Example() const override { return "GRIB2"; }
  std::string_view Requirement() const override { return "GRIB2 (it has no GRIB message)"; }

  bool MayBegin(std::string_view start) const override {
    // A netCDF file that was made from a GRIB file may have the word GRIB in its attributes.
    if (netcdf::NetcdfFile::BeginsLikeNetcdf(start)) return false;
    return grib::BeginsLikeGrib(start) || grib::BeginsCompressed(start);
  }

  // Does not check a compressed file, because the offsets in its listing (.idx) are those in the
  // decompressed file.
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
    THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<GribPart> parts, GribPartsOf(*index));
    if (parts.front().kind == GribPartKind::kWhole) {
      return Together(file.Path(), {GribFileAt(file.Path())}, {std::move(index)});
    }
    StormFile described = PartAt(file.Path(), parts.front());
    described.about = SummaryOfGrib(*index);
    for (std::size_t i = 1; i < parts.size(); ++i) {
      described.others.push_back(PartAt(file.Path(), parts[i]));
    }
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
    return Together(files.front().Path(), inputs, indexes);
  }

 private:
  static StormFile PartAt(const std::string& path, const GribPart& part) {
    StormFile described;
    described.path = path;
    described.times = part.times;
    described.member = part.member;
    described.part = {part.of, part.kind == GribPartKind::kInvariant};
    return described;
  }

  static absl::StatusOr<StormFile> Together(const std::string& path,
                                            const std::vector<GribInput>& files,
                                            const GribIndexes& indexes) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::shared_ptr<const GribStorm>> storms,
                                 MakeGribStorms(path, files, indexes));
    StormFile described = DescribeGribStorm(storms.front());
    for (std::size_t i = 1; i < storms.size(); ++i) {
      described.others.push_back(DescribeGribStorm(storms[i]));
    }
    return described;
  }
};

}  // namespace

std::shared_ptr<const StormFormat> MakeGribFormat() { return std::make_shared<GribFormat>(); }

}  // namespace thunderhead::storm_files
