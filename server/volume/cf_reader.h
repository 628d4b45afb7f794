// Reads one time of a CF file into HydrometeorFields: any order of dimensions, any direction of
// axes, uneven layers evened out, mixing ratios times the air's density. Knows no cache.
#pragma once

#include <cstddef>
#include <functional>

#include "absl/status/statusor.h"
#include "volume/cf_metadata.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// Reads record `record`. `checkpoint` is called before each variable with the share done; an error
// ends the reading with that error. Errors name the file, the variable and what to do.
absl::StatusOr<HydrometeorFields> ReadCfTime(
    const CfMetadata& metadata, std::size_t record,
    const std::function<absl::Status(double share)>& checkpoint);

}  // namespace thunderhead::volume
