// Converts render jobs between messages and values.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "access/access_control.h"
#include "jobs/job_board.h"
#include "service/engine/engine.h"
#include "thunderhead/v1/job.pb.h"

namespace thunderhead::service {

void ToMessage(const jobs::JobView& job, v1::RenderJob& message);
void ToMessage(const jobs::PictureView& picture, v1::RenderJobPictureState& message);

jobs::Asker AskerOf(const access::Caller& caller);

// Returns a picture as a job stores it. A scene without a storm gets the server's first storm, and
// a scene without a time gets the storm's last time. The valid time is added. If the storm or the
// time does not exist, the valid time stays empty, and the error is found when the picture is
// drawn.
jobs::PictureOrder OrderOf(const storm_store::StormStore& store,
                           const v1::RenderJobPicture& picture);

// Returns the path of a job's results on the HTTP port: "/results/KEY".
std::string ResultPathOf(const std::string& result_key);

// The job's key and the picture's index from a path such as "/results/KEY/7". The index has neither
// a sign nor leading zeros.
struct ResultPath {
  std::string key;
  std::size_t place = 0;
};
std::optional<ResultPath> ParseResultPath(std::string_view path);

}  // namespace thunderhead::service
