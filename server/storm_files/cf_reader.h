// Reads one time of a CF file into HydrometeorFields: any order of dimensions, any direction of
// axes, uneven layers evened out, mixing ratios times the air's density. Knows no cache.
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
