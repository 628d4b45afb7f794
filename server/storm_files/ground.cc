#include "storm_files/ground.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "absl/strings/str_cat.h"

namespace thunderhead::storm_files {
namespace {

absl::Status Refused(const std::string& where, const std::string& problem) {
  return absl::InvalidArgumentError(
      absl::StrCat(where, problem,
                   "; write heights above sea level in m (0 over the sea) for all columns and the "
                   "right units, or leave the variable out"));
}

std::string ColumnText(std::size_t column, std::size_t row) {
  return absl::StrCat("column (", column % row, ", ", column / row, ")");
}

}  // namespace

absl::Status CheckGround(const std::string& where, const std::vector<float>& ground_m,
                         std::size_t row) {
  const auto is_missing = [](float height_m) { return std::isnan(height_m); };
  if (!ground_m.empty() && std::ranges::all_of(ground_m, is_missing)) {
    return Refused(where, " is missing in every column");
  }
  const auto wrong = std::ranges::find_if(ground_m, [](float height_m) {
    return height_m < kLowestGround_m || height_m > kHighestGround_m;
  });
  if (wrong == ground_m.end()) return absl::OkStatus();
  const auto column = static_cast<std::size_t>(wrong - ground_m.begin());
  return Refused(
      where, absl::StrCat(" is ", *wrong, " m in ", ColumnText(column, row), ", which is not from ",
                          kLowestGround_m, " to ", kHighestGround_m, " m"));
}

absl::Status CheckGroundBelow(const std::string& where, const std::vector<float>& ground_m,
                              const std::vector<float>& amounts, std::size_t row) {
  std::size_t count = 0;
  std::optional<std::size_t> first;
  for (std::size_t column = 0; column < ground_m.size(); ++column) {
    if (!std::isnan(ground_m[column])) continue;
    bool has_amount = false;
    for (std::size_t i = column; i < amounts.size() && !has_amount; i += ground_m.size()) {
      has_amount = !std::isnan(amounts[i]);
    }
    if (!has_amount) continue;
    ++count;
    if (!first.has_value()) first = column;
  }
  if (!first.has_value()) return absl::OkStatus();
  return Refused(where, absl::StrCat(" is missing in ", count, " of ", ground_m.size(),
                                     " columns, the first of which is ", ColumnText(*first, row)));
}

bool RaiseToGround(const std::vector<float>& ground_m, std::vector<float>& interface_height_m) {
  // Heights are in single precision, so differences of centimetres are rounding.
  constexpr float kSame_m = 0.05F;
  const std::size_t columns = ground_m.size();
  if (columns == 0) return false;
  const std::size_t top = interface_height_m.size() - columns;
  bool moved = false;
  for (std::size_t i = 0; i < interface_height_m.size(); ++i) {
    float& height_m = interface_height_m[i];
    const float lowest_m = ground_m[i % columns];
    // The negated comparison is also true for NaN, so missing heights stay as they are.
    if (!(height_m < lowest_m - kSame_m)) continue;
    const float top_m = interface_height_m[top + i % columns];
    height_m = std::isnan(top_m) ? lowest_m : std::min(lowest_m, std::max(top_m, height_m));
    moved = true;
  }
  return moved;
}

}  // namespace thunderhead::storm_files
