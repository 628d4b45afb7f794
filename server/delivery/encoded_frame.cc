#include "delivery/encoded_frame.h"

#include "base/error_details.h"
#include "telemetry/metrics.h"

namespace thunderhead::delivery {
namespace {

Problem::Code CodeOf(absl::StatusCode code) {
  switch (code) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kOutOfRange:
      return Problem::Code::kScene;
    case absl::StatusCode::kResourceExhausted:
    case absl::StatusCode::kUnavailable:
      return Problem::Code::kBusy;
    default:
      return Problem::Code::kInternal;
  }
}

// Counts a failed request under its error reason, or else under its status code.
void CountRefusal(const absl::Status& why) {
  const std::string reason = base::DetailsOf(why).reason;
  telemetry::Counted()
      .refusals.Of(reason.empty() ? absl::StatusCodeToString(why.code()) : reason)
      .Add();
}

}  // namespace

Problem ProblemOf(std::uint64_t scene_revision, const absl::Status& why) {
  CountRefusal(why);
  return {scene_revision, std::string(why.message()), CodeOf(why.code())};
}

Problem UnreadableStorm(std::uint64_t scene_revision, const absl::Status& why) {
  if (absl::IsResourceExhausted(why)) return ProblemOf(scene_revision, why);
  CountRefusal(why);
  const bool gone = absl::IsNotFound(why);
  return {scene_revision, std::string(why.message()),
          gone ? Problem::Code::kStormGone : Problem::Code::kStormUnreadable};
}

}  // namespace thunderhead::delivery
