// Reads one time of a WRF output file into HydrometeorFields: heights and dry-air density from the
// file's own state, each hydrometeor's mixing ratio times that density, remapped to a regular
// height grid. Knows no series and no cache.
#pragma once

#include <cstddef>
#include <optional>

#include "absl/status/statusor.h"
#include "storm_files/storm_file.h"
#include "storm_files/vertical_remap.h"
#include "storm_files/wrf_metadata.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

// Reads record `record` of the file that `metadata` describes. `grid` is the storm's height grid,
// chosen from this time's heights if absent; a time whose condensate reaches beyond it gets more
// cells of the same spacing. Errors name the file, the variable and what to do; there is never half
// a result.
absl::StatusOr<volume::HydrometeorFields> ReadWrfTime(const WrfMetadata& metadata,
                                                      std::size_t record,
                                                      const std::optional<VerticalGrid>& grid,
                                                      const ReadCheckpoint& checkpoint);

// The height grid that ReadWrfTime would choose for that record.
absl::StatusOr<VerticalGrid> ReadWrfVerticalGrid(const WrfMetadata& metadata, std::size_t record);

}  // namespace thunderhead::storm_files
