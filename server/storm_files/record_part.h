// The part of a record that is read: some of its columns, and how many of them are averaged.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "glm/vec2.hpp"

namespace thunderhead::storm_files {

// Columns of a storm's regular grid, counted from west to east and from south to north.
struct ColumnWindow {
  glm::ivec2 low{0};      // the first column along x and along y
  glm::ivec2 columns{0};  // the number of columns along x and along y

  bool operator==(const ColumnWindow&) const = default;
};

struct RecordPart {
  // Makes the part that is the whole domain of record `index`. The conversion is implicit, because
  // most callers have only the index of a record.
  RecordPart(std::size_t index = 0) : record(index) {}

  std::size_t record;
  std::optional<ColumnWindow> window = std::nullopt;  // the whole domain if it is absent
  // The number of columns along x, and along y, that are averaged into one. The mass of each block
  // of columns is kept.
  int stride = 1;
};

// Returns INVALID_ARGUMENT, naming the file `path`, if the window is empty or not within the
// storm's `columns`. The stride may be 1 to the larger number of columns.
absl::Status CheckPart(const std::string& path, const RecordPart& part, const glm::ivec2& columns);

// Returns the number of columns along x and along y that reading the part gives. `columns` are the
// storm's. The part is one that CheckPart accepts.
glm::ivec2 ColumnsOf(const RecordPart& part, const glm::ivec2& columns);

}  // namespace thunderhead::storm_files
