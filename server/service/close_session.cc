#include "base/status.h"
#include "service/finished.h"
#include "service/handlers.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {

grpc::ServerUnaryReactor* CloseSession(Engine& engine, grpc::CallbackServerContext* context,
                                       const CallerRef& caller,
                                       const v1::CloseSessionRequest* request,
                                       v1::CloseSessionResponse* /*response*/) {
  absl::Status status = CheckLimits(*request);
  if (status.ok()) status = engine.sessions.Close(request->session_id());
  caller->Report("CloseSession", status);
  if (!status.ok()) return Answered(context, status);
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  SaveThen(engine, [reactor](const absl::Status& saved) {
    reactor->Finish(ToGrpcStatus(base::Annotate(
        saved, "the session is closed, but comes back if the server ends before that is saved")));
  });
  return reactor;
}

}  // namespace thunderhead::service
