// Requests for clouds as the generator's values.
#pragma once

#include "absl/status/statusor.h"
#include "clouds/cloud_file.h"
#include "clouds/cloud_shape.h"
#include "thunderhead/v1/cloud.pb.h"

namespace thunderhead::service {

clouds::CloudOrigin OriginOf(const v1::GenerateCloudRequest& request);

// The preset's shape with what the request says in place of it. INVALID_ARGUMENT if it makes no
// sense together; limits were checked before.
absl::StatusOr<clouds::CloudShape> ShapeOf(const v1::GenerateCloudRequest& request);

}  // namespace thunderhead::service
