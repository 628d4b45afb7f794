#include "jobs/next_try.h"

#include <algorithm>
#include <string>

#include "base/error_details.h"
#include "jobs/job_board.h"

namespace thunderhead::jobs {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr milliseconds kBusyPause = seconds(1);
constexpr milliseconds kFailedPause = seconds(5);
constexpr milliseconds kLongestPause = minutes(5);

// Returns true if the failure may be temporary. A picture that is too large is not, because the
// limits do not change while the server runs.
bool MayPass(const absl::Status& why) {
  const std::string& reason = base::DetailsOf(why).reason;
  if (reason == "PICTURE_TOO_LARGE" || reason == "TOO_MANY_SAMPLES") return false;
  return absl::IsUnavailable(why) || absl::IsAborted(why) || absl::IsCancelled(why) ||
         base::DetailsOf(why).retry_after.has_value();
}

}  // namespace

std::optional<NextTry> NextTryAfter(const absl::Status& why, int attempts, bool draining) {
  const base::ErrorDetails details = base::DetailsOf(why);
  const std::string& reason = details.reason;
  if (reason == "SHUTTING_DOWN" || reason == "RENDER_QUEUE_FULL" ||
      (absl::IsCancelled(why) && draining)) {
    return NextTry{false, kBusyPause};
  }
  const milliseconds pause = std::max(kFailedPause, details.retry_after.value_or(kFailedPause));
  if (reason == "STORAGE_HANGS") return NextTry{false, std::min(pause, kLongestPause)};
  if (!MayPass(why) || attempts >= JobBoard::kMaxAttempts) return std::nullopt;
  const milliseconds longer = pause * (1 << std::clamp(attempts - 1, 0, JobBoard::kMaxAttempts));
  return NextTry{true, std::min(longer, kLongestPause)};
}

}  // namespace thunderhead::jobs
