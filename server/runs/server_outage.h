// The time for which a run tolerates that its server fails to answer.
#pragma once

#include <chrono>
#include <optional>

#include "absl/status/status.h"
#include "base/time_source.h"

namespace thunderhead::runs {

// An outage of the server. It lasts from the end of the first call that failed until a call
// succeeds. It does not begin earlier, because a single call that the server does not answer can
// take longer than kPatience.
class ServerOutage {
 public:
  // Maximum time of an outage.
  static constexpr std::chrono::seconds kPatience{60};

  // `time` must outlive this object.
  explicit ServerOutage(const base::TimeSource& time = base::SteadyTime()) : time_(time) {}

  // Records that a call has failed with `why`. Returns true if the call is worth another try: the
  // error may be temporary (MayComeBack), and the outage has not lasted longer than kPatience.
  bool MayRetry(const absl::Status& why);

  // Records that the server has answered.
  void End() { since_.reset(); }

 private:
  const base::TimeSource& time_;
  std::optional<base::TimeSource::Clock::time_point> since_;  // absent if there is no outage
};

}  // namespace thunderhead::runs
