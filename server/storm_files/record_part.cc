#include "storm_files/record_part.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace thunderhead::storm_files {

absl::Status CheckPart(const std::string& path, const RecordPart& part, const glm::ivec2& columns) {
  const int most = std::max(columns.x, columns.y);
  if (part.stride < 1 || part.stride > most) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": a stride of ", part.stride,
                                                   " columns is not possible; give 1 to ", most));
  }
  if (!part.window.has_value()) return absl::OkStatus();
  const auto& [low, count] = *part.window;
  const auto fits = [](int first, int number, int all) {
    return first >= 0 && number >= 1 && number <= all && first <= all - number;
  };
  if (fits(low.x, count.x, columns.x) && fits(low.y, count.y, columns.y)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": the window of ", count.x, " x ", count.y, " columns from column ",
                   low.x, ", ", low.y, " is empty or not within the storm, which has ", columns.x,
                   " x ", columns.y, " columns; choose a window within these"));
}

glm::ivec2 ColumnsOf(const RecordPart& part, const glm::ivec2& columns) {
  const glm::ivec2 read = part.window.has_value() ? part.window->columns : columns;
  const int stride = std::max(part.stride, 1);
  return (read + stride - 1) / stride;
}

}  // namespace thunderhead::storm_files
