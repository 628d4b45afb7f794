#include "runs/server_outage.h"

#include "runs/server_link.h"

namespace thunderhead::runs {

bool ServerOutage::MayRetry(const absl::Status& why) {
  const base::TimeSource::Clock::time_point now = time_.Now();
  if (!since_.has_value()) since_ = now;
  return MayComeBack(why) && now - *since_ <= kPatience;
}

}  // namespace thunderhead::runs
