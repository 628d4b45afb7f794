#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/status.h"
#include "rpc_port/finished.h"
#include "service/handlers.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {
namespace {

// Returns UNAVAILABLE if saving the end of the session failed, whatever the cause.
absl::Status EndSaved(const absl::Status& removed) {
  if (removed.ok()) return removed;
  const absl::Status unsaved = base::WithDetails(
      absl::UnavailableError(absl::StrCat(
          "the session is closed, but exists again if the server restarts before this is saved: ",
          removed.message())),
      base::DetailsOf(removed));
  return base::WithDetails(unsaved, {.reason = "SESSION_END_NOT_SAVED"});
}

}  // namespace

grpc::ServerUnaryReactor* CloseSession(Engine& engine, grpc::CallbackServerContext* context,
                                       const CallerRef& caller,
                                       const v1::CloseSessionRequest* request,
                                       v1::CloseSessionResponse* response) {
  absl::Status status = CheckLimits(*request);
  if (status.ok()) status = engine.sessions.Close(request->session_id());
  caller->Report("CloseSession", status);
  if (!status.ok()) return rpc_port::Refused(context, status);
  auto* const answer = new rpc_port::Answer(context, engine.limits, caller, *response);
  SaveThen(engine, [answer](const session::SessionKeeper::Outcome& outcome) {
    answer->Give(EndSaved(outcome.removed));
  });
  return answer;
}

}  // namespace thunderhead::service
