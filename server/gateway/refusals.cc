#include "gateway/refusals.h"

#include "base/error_details.h"

namespace thunderhead::gateway {

absl::Status HostNotAllowed() {
  return base::WithDetails(absl::PermissionDeniedError("the Host header names another server"),
                           {.reason = "HOST_NOT_ALLOWED"});
}

absl::Status OriginNotAllowed() {
  return base::WithDetails(absl::PermissionDeniedError("pages of that origin may not call"),
                           {.reason = "ORIGIN_NOT_ALLOWED"});
}

absl::Status HeaderTooLarge() {
  return base::WithDetails(absl::ResourceExhaustedError("the request's header is too large"),
                           {.reason = "HEADER_TOO_LARGE"});
}

absl::Status MessageTooLarge() {
  return base::WithDetails(absl::ResourceExhaustedError("the request's message is too large"),
                           {.reason = "MESSAGE_TOO_LARGE"});
}

absl::Status AnswersNotTaken() {
  return base::WithDetails(
      absl::ResourceExhaustedError(
          "too many responses wait for slow clients to read them; try again in a few seconds"),
      {.reason = "ANSWERS_NOT_TAKEN"});
}

absl::Status TooManyEmptyFrames() {
  return base::WithDetails(
      absl::ResourceExhaustedError("too many control frames or empty frames came on a WebSocket"),
      {.reason = "TOO_MANY_EMPTY_FRAMES"});
}

void TellOfRefusal(const GatewayOptions& options, const std::string& peer, const char* act,
                   const absl::Status& why) {
  if (options.on_refusal) options.on_refusal({peer, act, why});
}

}  // namespace thunderhead::gateway
