// Turns one time on a model's own layers into fields on even heights. Every format uses these
// functions, so units, moist or dry air, missing values and heights mean the same for all of them.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>

#include "absl/status/statusor.h"
#include "storm_files/layer_source.h"
#include "storm_files/storm_file.h"
#include "storm_files/vertical_remap.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

// Reads a part of the source and remaps it to even heights. Each column, or each block of `stride`
// x `stride` columns, keeps its mass. `grid` is the storm's height grid. If it is absent, the grid
// is chosen from the source's heights. If the source reaches beyond the grid, cells of the same
// spacing are added. Errors name the file, the variable and what to do.
absl::StatusOr<volume::HydrometeorFields> ReadOnHeights(LayerSource& source, const RecordPart& part,
                                                        const std::optional<VerticalGrid>& grid,
                                                        const ReadCheckpoint& checkpoint);

// Returns the height grid that ReadOnHeights would choose.
absl::StatusOr<VerticalGrid> HeightGridOf(LayerSource& source);

// Opens the source of a record.
using OpenRecord = std::function<absl::StatusOr<std::unique_ptr<LayerSource>>(std::size_t record)>;

// Returns a reader whose records are the sources that `open` opens.
std::shared_ptr<const RecordReader> MakeRecordReader(OpenRecord open);

}  // namespace thunderhead::storm_files
