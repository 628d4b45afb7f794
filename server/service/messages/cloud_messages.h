// Converts requests for clouds to the generator's values.
#pragma once

#include "absl/status/statusor.h"
#include "clouds/cloud_file.h"
#include "clouds/cloud_shape.h"
#include "thunderhead/v1/cloud.pb.h"

namespace thunderhead::service {

clouds::CloudOrigin OriginOf(const v1::GenerateCloudRequest& request);

// Returns the preset's shape with the values that the request overrides. Returns INVALID_ARGUMENT
// if the values contradict each other. The limits must have been checked before.
absl::StatusOr<clouds::CloudShape> ShapeOf(const v1::GenerateCloudRequest& request);

}  // namespace thunderhead::service
