// Requests one picture from a service in this process or in another one.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "absl/status/statusor.h"
#include "grpcpp/channel.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::runs {

// Called on the calling thread with the progress of the path tracing that the picture waits for.
using OnPictureProgress = std::function<void(const v1::RenderImageProgress&)>;

// Requests a picture and waits for it. If `token` is not empty, it is sent to the server. Returns
// CANCELLED if `stop` is requested before the picture arrives. `progress` may be empty.
absl::StatusOr<v1::RenderImageResponse> CallForPicture(
    const std::shared_ptr<grpc::Channel>& channel, const v1::RenderImageRequest& request,
    const std::string& token, const std::stop_token& stop, const OnPictureProgress& progress);

}  // namespace thunderhead::runs
