#include "storm_files/mystic_format.h"

#include "base/status.h"
#include "storm_files/cloud_text.h"
#include "storm_files/text_start.h"

namespace thunderhead::storm_files {
namespace {

// Flags that say what the columns of the lines are. 2 means extinction and radius.
constexpr int kOpticalProperties = 1;
constexpr int kWaterAndRadius = 3;

void SetMysticColumns(int flag, CloudHeader& header) {
  header.columns.values = flag == kOpticalProperties ? 3 : 2;
  if (flag == kWaterAndRadius) {
    header.columns.radius_at = 1;
    header.variable = "lwc";
    header.assumptions.emplace_back(
        "The particles are taken as water droplets: files of ice clouds have the same layout.");
    return;
  }
  header.quantity = volume::Quantity::kExtinction;
  header.variable = "extinction";
  header.assumptions.emplace_back(flag == kOpticalProperties
                                      ? "Asymmetry parameters and albedos are not used."
                                      : "Radii are not used, because the file has extinction.");
}

absl::StatusOr<CloudHeader> ReadMysticHeader(NumberText& text) {
  CloudHeader header;
  header.about = "MYSTIC cloud file";
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the size of the grid"));
  THUNDERHEAD_RETURN_IF_ERROR(ReadCloudSize(text, header));
  THUNDERHEAD_ASSIGN_OR_RETURN(const int flag,
                               text.Integer("the flag", kOpticalProperties, kWaterAndRadius));
  if (text.AtNumber()) {
    return text.Error(
        "has a fifth number, as before libRadtran 2; keep the flag only, as the fourth number");
  }
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the distances and heights"));
  THUNDERHEAD_RETURN_IF_ERROR(ReadCloudSpacing(text, header));
  // MYSTIC has one height more than layers.
  THUNDERHEAD_RETURN_IF_ERROR(ReadCloudHeights(text, true, header));
  if (!header.heights_are_faces) {
    return text.Error("has as many heights as layers; give one more, those of their faces");
  }
  SetMysticColumns(flag, header);
  return header;
}

constexpr CloudDialect kMysticDialect = {"MYSTIC", "#%", ReadMysticHeader};

// The layout is documented in the user's guide of libRadtran 2.0 ("wc_file 3D"), and was compared
// with the reader in its wcloud3d.c. The first line has the numbers of cells and a flag. The second
// has the distances and the heights of faces in km. Each further line has the indices of a cell,
// which count from 1, and its values. With flag 1 these are the extinction in km-1, the asymmetry
// parameter and the albedo. With flag 2 they are the extinction and the effective radius in um.
// With flag 3 they are the liquid water content in g m-3 and the effective radius. Before version 2
// the flag was the fifth number. Such files are refused.
class MysticFormat final : public StormFormat {
 public:
  std::string_view Name() const override { return "a MYSTIC cloud file"; }
  std::string_view Example() const override { return "MYSTIC text"; }
  std::string_view Requirement() const override {
    return "a MYSTIC cloud file (it does not begin with three numbers of cells and a flag)";
  }

  bool MayBegin(std::string_view start) const override {
    const std::vector<StartLine> lines = FirstTextLines(start, kMysticDialect.comments);
    constexpr std::size_t kSizeAndFlag = 4;
    if (lines.size() < 2 || !lines[0].BeginsWithSize() || !lines[0].only_numbers) return false;
    const std::vector<double>& first = lines[0].numbers;
    if (first.size() != kSizeAndFlag && first.size() != kSizeAndFlag + 1) return false;
    if (!(first[3] >= 0.0 && first[3] <= kWaterAndRadius)) return false;
    return lines[1].HasNumbers(static_cast<std::size_t>(first[2]) + 3);
  }

  FormatFit Sniff(const UnknownFile& file) const override {
    return MayBegin(file.Start()) ? FormatFit::kModelLayout : FormatFit::kNone;
  }

  absl::StatusOr<StormFile> Describe(const UnknownFile& file) const override {
    THUNDERHEAD_RETURN_IF_ERROR(file.Bytes().status());
    return DescribeCloudText(*file.Bytes(), kMysticDialect);
  }
};

}  // namespace

std::shared_ptr<const StormFormat> MakeMysticFormat() { return std::make_shared<MysticFormat>(); }

}  // namespace thunderhead::storm_files
