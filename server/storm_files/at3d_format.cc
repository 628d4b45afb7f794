#include "storm_files/at3d_format.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_split.h"
#include "base/status.h"
#include "storm_files/cloud_text.h"
#include "storm_files/text_start.h"

namespace thunderhead::storm_files {
namespace {

constexpr std::size_t kIndices = 3;

// Returns the names of the columns, in lower case, if the line has them: "i,j,k,lwc,reff".
std::vector<std::string> ColumnNames(std::string_view line) {
  const std::string lower = absl::AsciiStrToLower(std::string(line));
  const std::vector<std::string> names =
      absl::StrSplit(lower, absl::ByAnyChar(", \t\r"), absl::SkipEmpty());
  if (names.size() <= kIndices) return {};
  const bool is_grid = (names[0] == "i" && names[1] == "j" && names[2] == "k") ||
                       (names[0] == "x" && names[1] == "y" && names[2] == "z");
  return is_grid ? names : std::vector<std::string>();
}

// Returns the index of the first column with one of these names, counted from the column after the
// three indices. Returns -1 if there is none.
int ColumnOf(const std::vector<std::string>& names,
             std::initializer_list<std::string_view> wanted) {
  const auto found = std::find_if(
      names.begin() + kIndices, names.end(),
      [&](const std::string& name) { return std::ranges::find(wanted, name) != wanted.end(); });
  return found == names.end()
             ? -1
             : static_cast<int>(found - names.begin()) - static_cast<int>(kIndices);
}

absl::Status SetNamedColumns(NumberText& text, CloudHeader& header) {
  const std::vector<std::string> names = ColumnNames(text.Rest());
  header.columns.values = static_cast<int>(names.size()) - static_cast<int>(kIndices);
  header.columns.amount_at = ColumnOf(names, {"lwc", "density"});
  header.columns.radius_at = ColumnOf(names, {"reff"});
  header.variable = "lwc";
  if (!names.empty() && header.columns.amount_at >= 0) return absl::OkStatus();
  header.columns.amount_at = names.empty() ? -1 : ColumnOf(names, {"extinction", "ext"});
  header.columns.radius_at = -1;
  header.quantity = volume::Quantity::kExtinction;
  header.variable = "extinction";
  if (header.columns.amount_at >= 0) return absl::OkStatus();
  return text.Error("names no column lwc or extinction after i,j,k or x,y,z; name the columns");
}

absl::StatusOr<CloudHeader> ReadAt3dHeader(NumberText& text) {
  CloudHeader header;
  header.about = "AT3D cloud field";
  header.first_index = 0;
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the size of the grid"));
  THUNDERHEAD_RETURN_IF_ERROR(ReadCloudSize(text, header));
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the distance between columns"));
  THUNDERHEAD_RETURN_IF_ERROR(ReadCloudSpacing(text, header));
  const bool has_names = !text.AtNumber();
  if (has_names) THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the heights"));
  THUNDERHEAD_RETURN_IF_ERROR(ReadCloudHeights(text, false, header));
  if (has_names) {
    THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the names of the columns"));
    THUNDERHEAD_RETURN_IF_ERROR(SetNamedColumns(text, header));
    return header;
  }
  header.variable = "lwc";
  header.columns.values = 2;
  header.columns.radius_at = 1;
  return header;
}

constexpr CloudDialect kAt3dDialect = {"AT3D", "#", ReadAt3dHeader};

// Returns whether the lines are a grid, its heights, and points with an amount and a radius. The
// standard property files of SHDOM have the same header, but longer lines.
bool LooksLikePlainText(const std::vector<StartLine>& lines, std::size_t levels) {
  constexpr std::size_t kColumns = 5;
  return lines.size() > 2 && lines[1].HasNumbers(2 + levels) && !lines[1].is_cut &&
         lines[2].HasNumbers(kColumns);
}

bool LooksLikeTable(const std::vector<StartLine>& lines, std::size_t levels) {
  if (lines.size() < 3 || !lines[1].HasNumbers(2) || !lines[2].HasNumbers(levels)) return false;
  return lines.size() == 3 || !ColumnNames(lines[3].text).empty();
}

// Reads two layouts. Both have comments after '#', distances and heights of grid points in km,
// liquid water content in g m-3, effective radius in um, and indices from 0. The layouts are:
// - a table whose columns have names, as AT3D's util.py, load_from_csv, reads it. The file
//   rico32x37x26.txt of AT3D is one. Extinction is in km-1.
// - the plain text of the file les_stcu.txt in AT3D and pyshdom, whose distances and heights are on
//   one line.
class At3dFormat final : public StormFormat {
 public:
  std::string_view Name() const override { return "an AT3D cloud field"; }
  std::string_view Example() const override { return "AT3D text"; }
  std::string_view Requirement() const override {
    return "an AT3D cloud field (it does not begin with its grid and the names of its columns)";
  }

  bool MayBegin(std::string_view start) const override {
    const std::vector<StartLine> lines = FirstTextLines(start, kAt3dDialect.comments);
    if (lines.empty() || !lines[0].BeginsWithSize() || !lines[0].HasNumbers(kIndices)) return false;
    const auto levels = static_cast<std::size_t>(lines[0].numbers[2]);
    return LooksLikePlainText(lines, levels) || LooksLikeTable(lines, levels);
  }

  FormatFit Sniff(const UnknownFile& file) const override {
    return MayBegin(file.Start()) ? FormatFit::kModelLayout : FormatFit::kNone;
  }

  absl::StatusOr<StormFile> Describe(const UnknownFile& file) const override {
    THUNDERHEAD_RETURN_IF_ERROR(file.Bytes().status());
    return DescribeCloudText(*file.Bytes(), kAt3dDialect);
  }
};

}  // namespace

std::shared_ptr<const StormFormat> MakeAt3dFormat() { return std::make_shared<At3dFormat>(); }

}  // namespace thunderhead::storm_files
