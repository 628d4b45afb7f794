#include "base/status.h"
#include "rpc_port/finished.h"
#include "service/jobs/job_messages.h"
#include "service/jobs/render_job_handlers.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {
namespace {

absl::Status Get(const jobs::Jobs& jobs, const access::Caller& caller,
                 const v1::GetRenderJobRequest& request, v1::GetRenderJobResponse& response) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request));
  THUNDERHEAD_ASSIGN_OR_RETURN(const jobs::JobNews news,
                               jobs.Get(request.job_id(), AskerOf(caller)));
  ToMessage(news.job, *response.mutable_job());
  for (const jobs::PictureView& picture : news.pictures) {
    ToMessage(picture, *response.add_pictures());
  }
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* GetRenderJob(jobs::Jobs& jobs, const Limits& limits,
                                       grpc::CallbackServerContext* context,
                                       const CallerRef& caller,
                                       const v1::GetRenderJobRequest* request,
                                       v1::GetRenderJobResponse* response) {
  return rpc_port::Finished(limits, context, caller, Get(jobs, *caller, *request, *response),
                            *response);
}

}  // namespace thunderhead::service
