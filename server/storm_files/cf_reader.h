// Reads one time of a CF file into HydrometeorFields. Dimensions may be in any order, and axes in
// any direction. Layers of uneven thickness are averaged onto cells of equal thickness, and mixing
// ratios are multiplied by the air's density. This code does not depend on the cache of storms.
#pragma once

#include <cstddef>

#include "absl/status/statusor.h"
#include "storm_files/cf_metadata.h"
#include "storm_files/storm_file.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

// Reads record `record`. Errors name the file, the variable and what to do.
absl::StatusOr<volume::HydrometeorFields> ReadCfTime(const CfMetadata& metadata, std::size_t record,
                                                     const ReadCheckpoint& checkpoint);

}  // namespace thunderhead::storm_files
