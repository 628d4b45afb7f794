#include <utility>

#include "base/error_details.h"
#include "base/status.h"
#include "rpc_port/finished.h"
#include "service/jobs/job_messages.h"
#include "service/jobs/render_job_handlers.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {
namespace {

// Checks everything in the request except the scenes. A bad scene makes only its own picture fail
// later.
absl::Status CheckShape(v1::CreateRenderJobRequest request) {
  for (v1::RenderJobPicture& picture : *request.mutable_pictures()) picture.clear_scene();
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request));
  if (!request.pictures().empty()) return absl::OkStatus();
  return base::InvalidField("pictures", "is empty; a job needs at least one picture",
                            "NO_PICTURES");
}

}  // namespace

grpc::ServerUnaryReactor* CreateRenderJob(Engine& engine, jobs::Jobs& jobs,
                                          grpc::CallbackServerContext* context,
                                          const CallerRef& caller,
                                          const v1::CreateRenderJobRequest* request,
                                          v1::CreateRenderJobResponse* response) {
  if (const absl::Status wrong = CheckShape(*request); !wrong.ok()) {
    caller->Report("CreateRenderJob", wrong);
    return rpc_port::Refused(context, wrong);
  }
  jobs::NewJob job{caller->identity().name, request->label(), {}};
  job.pictures.reserve(static_cast<std::size_t>(request->pictures_size()));
  for (const v1::RenderJobPicture& picture : request->pictures()) {
    job.pictures.push_back(OrderOf(engine.store, picture));
  }
  auto* const answer = new rpc_port::Answer(context, engine.limits, caller, *response);
  jobs.Create(std::move(job),
              [answer, caller, response](const absl::StatusOr<jobs::JobView>& created) {
                caller->Report("CreateRenderJob", created.status());
                if (created.ok()) ToMessage(*created, *response->mutable_job());
                answer->Give(created.status());
              });
  return answer;
}

}  // namespace thunderhead::service
