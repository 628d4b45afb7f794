#include "accuracy/priced_settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "accuracy/named_settings.h"
#include "base/status.h"

namespace thunderhead::accuracy {
namespace {

using Cells = std::vector<absl::string_view>;

constexpr std::array<absl::string_view, 8> kNeeded = {
    "renderer",    "mode",         "transport",    "slices",
    "image_scale", "jpeg_quality", "milliseconds", "relative_rmse"};
// Columns of results that the choice of a setting ignores.
constexpr std::array<absl::string_view, 7> kPassedOver = {
    "milliseconds_spread", "bytes",     "relative_bias", "flip",
    "estimated_error",     "error_low", "error_high"};

// Columns of settings that scenes cannot choose, with the value that scenes use. Rows with other
// values are left out.
struct Fixed {
  absl::string_view column;
  absl::string_view value;
};
constexpr std::array<Fixed, 2> kFixed = {{{"light_detail", "1"}, {"precision", "half"}}};

// An optional column. Tables without it contain only rows without path-traced correction.
constexpr absl::string_view kMillionPaths = "million_paths";

bool IsFixed(absl::string_view name) {
  return std::any_of(kFixed.begin(), kFixed.end(),
                     [&](const Fixed& fixed) { return fixed.column == name; });
}

// Returns true if a scene can request the row's setting. `names` are the columns' names.
bool IsOnOffer(const Cells& names, const Cells& cells) {
  if (names.size() != cells.size()) return true;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (const Fixed& fixed : kFixed) {
      if (fixed.column == names[i] && fixed.value != cells[i]) return false;
    }
  }
  return true;
}

template <typename Names>
bool IsIn(const Names& names, absl::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Returns the indices of the needed columns, in the order of kNeeded.
absl::StatusOr<std::vector<std::size_t>> ColumnsOf(const Cells& names) {
  for (const absl::string_view name : names) {
    if (IsIn(kNeeded, name) || IsIn(kPassedOver, name) || IsFixed(name)) continue;
    if (name == kMillionPaths) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("its column '", name, "' is unknown, so its rows cannot be told apart"));
  }
  std::vector<std::size_t> columns;
  for (const absl::string_view needed : kNeeded) {
    const auto found = std::find(names.begin(), names.end(), needed);
    if (found == names.end()) {
      return absl::InvalidArgumentError(absl::StrCat("it has no column '", needed, "'"));
    }
    columns.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  return columns;
}

bool ReadNumber(absl::string_view text, double* value) {
  return absl::SimpleAtod(text, value) && std::isfinite(*value) && *value >= 0.0;
}

// Reads a row; `cells` are in the order of kNeeded.
bool ReadRow(const Cells& cells, PricedSetting* row) {
  Setting& setting = row->setting;
  const auto technique =
      TechniqueNamed(std::string(cells[0]), std::string(cells[1]), std::string(cells[2]));
  int count = 0;
  if (!technique.has_value() || !absl::SimpleAtoi(cells[3], &count) || count <= 0) return false;
  setting.technique = *technique;
  scene::SetCount(&setting.technique, count);
  return ReadNumber(cells[4], &setting.image_scale) && setting.image_scale > 0.0 &&
         setting.image_scale <= 2.0 && absl::SimpleAtoi(cells[5], &setting.jpeg_quality) &&
         ReadNumber(cells[6], &row->milliseconds) && row->milliseconds > 0.0 &&
         ReadNumber(cells[7], &row->relative_rmse);
}

// Reads the number of traced paths. Returns true if it was read or if the table has no such column.
bool ReadMillionPaths(const Cells& names, const Cells& cells, double* value) {
  const auto found = std::find(names.begin(), names.end(), kMillionPaths);
  if (found == names.end()) return true;
  return ReadNumber(cells[static_cast<std::size_t>(found - names.begin())], value);
}

absl::Status ReadSize(absl::string_view comment, glm::ivec2* size_px) {
  if (!absl::ConsumePrefix(&comment, "# size: ")) return absl::OkStatus();
  const std::pair<absl::string_view, absl::string_view> size = absl::StrSplit(comment, 'x');
  const bool read = absl::SimpleAtoi(size.first, &size_px->x) &&
                    absl::SimpleAtoi(size.second, &size_px->y) && size_px->x > 0 && size_px->y > 0;
  if (read) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("its size '", comment, "' is not WIDTHxHEIGHT"));
}

void KeepCommonestJpegQuality(std::vector<PricedSetting>* rows) {
  std::map<int, std::size_t> counts;
  for (const PricedSetting& row : *rows) ++counts[row.setting.jpeg_quality];
  const auto fewer = [](const auto& a, const auto& b) { return a.second < b.second; };
  const int commonest = std::max_element(counts.begin(), counts.end(), fewer)->first;
  const auto other = [&](const PricedSetting& row) {
    return row.setting.jpeg_quality != commonest;
  };
  rows->erase(std::remove_if(rows->begin(), rows->end(), other), rows->end());
}

}  // namespace

absl::StatusOr<PricedSettings> ReadPricedSettings(std::string_view text) {
  PricedSettings table;
  std::vector<std::size_t> columns;
  Cells names;
  const Cells lines = absl::StrSplit(absl::string_view(text.data(), text.size()), '\n');
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const absl::string_view line = absl::StripSuffix(lines[i], "\r");
    if (line.empty()) continue;
    if (line.front() == '#') {
      THUNDERHEAD_RETURN_IF_ERROR(ReadSize(line, &table.size_px));
      continue;
    }
    const Cells cells = absl::StrSplit(line, ',');
    if (columns.empty()) {
      THUNDERHEAD_ASSIGN_OR_RETURN(columns, ColumnsOf(cells));
      names = cells;
      continue;
    }
    if (!IsOnOffer(names, cells)) continue;
    Cells needed;
    for (const std::size_t column : columns) {
      if (cells.size() == names.size()) needed.push_back(cells[column]);
    }
    PricedSetting row;
    if (needed.empty() || !ReadRow(needed, &row) ||
        !ReadMillionPaths(names, cells, &row.setting.million_paths)) {
      return absl::InvalidArgumentError(
          absl::StrCat("its line ", i + 1, ", '", line, "', is not a row of ",
                       absl::StrJoin(kNeeded, ", "), " that this program knows"));
    }
    table.rows.push_back(row);
  }
  if (table.size_px.x == 0) {
    return absl::InvalidArgumentError(
        "it has no line with the size of its pictures; add one such as '# size: 160x107'");
  }
  if (table.rows.empty()) return absl::InvalidArgumentError("it has no rows");
  KeepCommonestJpegQuality(&table.rows);
  return table;
}

}  // namespace thunderhead::accuracy
