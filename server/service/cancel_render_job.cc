#include "service/finished.h"
#include "service/job_messages.h"
#include "service/messages/limits_check.h"
#include "service/render_job_handlers.h"

namespace thunderhead::service {

grpc::ServerUnaryReactor* CancelRenderJob(jobs::Jobs& jobs, grpc::CallbackServerContext* context,
                                          const CallerRef& caller,
                                          const v1::CancelRenderJobRequest* request,
                                          v1::CancelRenderJobResponse* response) {
  if (const absl::Status wrong = CheckLimits(*request); !wrong.ok()) {
    return Finished(context, *caller, wrong);
  }
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  jobs.Cancel(request->job_id(), AskerOf(*caller), request->forget(),
              [reactor, caller, request, response](const absl::StatusOr<jobs::JobView>& ended) {
                caller->Report("CancelRenderJob", ended.status());
                if (ended.ok() && !request->forget()) ToMessage(*ended, *response->mutable_job());
                reactor->Finish(ToGrpcStatus(ended.status()));
              });
  return reactor;
}

}  // namespace thunderhead::service
