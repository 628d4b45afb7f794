#include "base/error_details.h"
#include "base/status.h"
#include "rpc_port/finished.h"
#include "service/jobs/job_messages.h"
#include "service/jobs/render_job_handlers.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {
namespace {

absl::Status List(const jobs::Jobs& jobs, const access::Caller& caller,
                  const v1::ListRenderJobsRequest& request, v1::ListRenderJobsResponse& response) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request));
  const jobs::Asker asker = AskerOf(caller);
  if (request.everybodys() && !asker.is_operator) {
    return base::WithDetails(
        absl::PermissionDeniedError("only operators may list the render jobs of all identities"),
        {.reason = "ROLE_MAY_NOT", .metadata = {{"role", access::NameOf(caller.identity().role)}}});
  }
  for (const jobs::JobView& job : jobs.List(asker.name, request.everybodys(), request.label())) {
    ToMessage(job, *response.add_jobs());
  }
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* ListRenderJobs(jobs::Jobs& jobs, const Limits& limits,
                                         grpc::CallbackServerContext* context,
                                         const CallerRef& caller,
                                         const v1::ListRenderJobsRequest* request,
                                         v1::ListRenderJobsResponse* response) {
  return rpc_port::Finished(limits, context, caller, List(jobs, *caller, *request, *response),
                            *response);
}

}  // namespace thunderhead::service
