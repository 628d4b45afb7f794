#include "rpc_port/finished.h"
#include "service/jobs/job_messages.h"
#include "service/jobs/render_job_handlers.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {

grpc::ServerUnaryReactor* CancelRenderJob(jobs::Jobs& jobs, const Limits& limits,
                                          grpc::CallbackServerContext* context,
                                          const CallerRef& caller,
                                          const v1::CancelRenderJobRequest* request,
                                          v1::CancelRenderJobResponse* response) {
  if (const absl::Status wrong = CheckLimits(*request); !wrong.ok()) {
    return rpc_port::Refused(context, *caller, wrong);
  }
  auto* const answer = new rpc_port::Answer(context, limits, caller, *response);
  jobs.Cancel(request->job_id(), AskerOf(*caller), request->forget(),
              [answer, caller, request, response](const absl::StatusOr<jobs::JobView>& ended) {
                caller->Report("CancelRenderJob", ended.status());
                if (ended.ok() && !request->forget()) ToMessage(*ended, *response->mutable_job());
                answer->Give(ended.status());
              });
  return answer;
}

}  // namespace thunderhead::service
