#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/status.h"
#include "rpc_port/finished.h"
#include "service/handlers.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {
namespace {

absl::Status Acknowledge(Engine& engine, const v1::AcknowledgeFrameRequest& request) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request));
  THUNDERHEAD_ASSIGN_OR_RETURN(const session::FoundSession found,
                               engine.sessions.Find(request.session_id()));
  if (found.session->hub().Acknowledge(request.viewer_id(), request.sequence()))
    return absl::OkStatus();
  return base::WithDetails(absl::NotFoundError(absl::StrCat(
                               "viewer_id is ", request.viewer_id(),
                               "; no such viewer watches the session (its stream may have ended)")),
                           {.reason = "VIEWER_NOT_FOUND",
                            .metadata = {{"viewer_id", absl::StrCat(request.viewer_id())}}});
}

}  // namespace

grpc::ServerUnaryReactor* AcknowledgeFrame(Engine& engine, grpc::CallbackServerContext* context,
                                           const CallerRef& caller,
                                           const v1::AcknowledgeFrameRequest* request,
                                           v1::AcknowledgeFrameResponse* response) {
  return rpc_port::Finished(engine.limits, context, caller, Acknowledge(engine, *request),
                            *response);
}

}  // namespace thunderhead::service
