// Reads one time of a WRF output file into HydrometeorFields. Heights and the density of dry air
// are computed from the file's state of the air. Each hydrometeor's mixing ratio is multiplied by
// that density and remapped to a regular height grid. This code does not depend on series of files
// or on the cache of storms.
#pragma once

#include <cstddef>
#include <optional>

#include "absl/status/statusor.h"
#include "storm_files/storm_file.h"
#include "storm_files/vertical_remap.h"
#include "storm_files/wrf_metadata.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

// Reads record `record` of the file that `metadata` describes. `grid` is the storm's height grid.
// If it is absent, the grid is chosen from the heights of this record. If condensate reaches beyond
// the grid, cells of the same spacing are added. Errors name the file, the variable and what to do.
absl::StatusOr<volume::HydrometeorFields> ReadWrfTime(const WrfMetadata& metadata,
                                                      std::size_t record,
                                                      const std::optional<VerticalGrid>& grid,
                                                      const ReadCheckpoint& checkpoint);

// Returns the height grid that ReadWrfTime would choose for that record.
absl::StatusOr<VerticalGrid> ReadWrfVerticalGrid(const WrfMetadata& metadata, std::size_t record);

}  // namespace thunderhead::storm_files
