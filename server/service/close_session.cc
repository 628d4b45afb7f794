#include "base/status.h"
#include "service/finished.h"
#include "service/handlers.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {

grpc::ServerUnaryReactor* CloseSession(Engine& engine, grpc::CallbackServerContext* context,
                                       const CallerRef& caller,
                                       const v1::CloseSessionRequest* request,
                                       v1::CloseSessionResponse* response) {
  absl::Status status = CheckLimits(*request);
  if (status.ok()) status = engine.sessions.Close(request->session_id());
  caller->Report("CloseSession", status);
  if (!status.ok()) return Refused(context, status);
  auto* const answer = new Answer(context, engine.limits, caller, *response);
  SaveThen(engine, [answer](const absl::Status& saved) {
    answer->Give(base::Annotate(
        saved, "the session is closed, but comes back if the server ends before that is saved"));
  });
  return answer;
}

}  // namespace thunderhead::service
