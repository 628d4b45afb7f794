// Reads one time of a CF netCDF file, on the file's own layers.
#pragma once

#include <cstddef>
#include <memory>

#include "absl/status/statusor.h"
#include "storm_files/cf_metadata.h"
#include "storm_files/layer_source.h"

namespace thunderhead::storm_files {

// Opens record `record` of the file that `metadata` describes. Errors name the file, the variable
// and what to do.
absl::StatusOr<std::unique_ptr<LayerSource>> OpenCfTime(std::shared_ptr<const CfMetadata> metadata,
                                                        std::size_t record);

}  // namespace thunderhead::storm_files
