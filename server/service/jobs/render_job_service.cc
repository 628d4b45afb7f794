#include "service/jobs/render_job_service.h"

#include <utility>

#include "base/error_details.h"
#include "service/jobs/render_job_handlers.h"

namespace thunderhead::service {
namespace {

absl::Status NoJobs() {
  return base::WithDetails(
      absl::FailedPreconditionError("this server has no render jobs; its operator can start it "
                                    "with --state FOLDER or --jobs-folder FOLDER"),
      {.reason = "NO_JOBS_HERE"});
}

}  // namespace

RenderJobService::RenderJobService(Engine& engine, access::AccessControl& access_control,
                                   rpc_port::ConnectionCalls& calls, jobs::Jobs* jobs,
                                   const JobFiles& files)
    : engine_(engine),
      jobs_(jobs),
      entrance_(access_control, calls, jobs != nullptr ? absl::OkStatus() : NoJobs()),
      open_(files.open_result),
      // The executor's queue has room for every read: each stream waits for at most one read at a
      // time, and the access control limits the number of streams.
      reading_({.threads = kReadingThreads,
                .max_waiting = access_control.limits().max_streams,
                .max_waiting_each = access_control.limits().max_streams_per_identity}),
      calls_(files.patience, engine.sessions.time()) {}

grpc::ServerUnaryReactor* RenderJobService::CreateRenderJob(
    grpc::CallbackServerContext* context, const v1::CreateRenderJobRequest* request,
    v1::CreateRenderJobResponse* response) {
  return entrance_.Unary("CreateRenderJob", context, [&](const CallerRef& caller) {
    return service::CreateRenderJob(engine_, *jobs_, context, caller, request, response);
  });
}

grpc::ServerUnaryReactor* RenderJobService::GetRenderJob(grpc::CallbackServerContext* context,
                                                         const v1::GetRenderJobRequest* request,
                                                         v1::GetRenderJobResponse* response) {
  return entrance_.Unary("GetRenderJob", context, [&](const CallerRef& caller) {
    return service::GetRenderJob(*jobs_, engine_.limits, context, caller, request, response);
  });
}

grpc::ServerUnaryReactor* RenderJobService::ListRenderJobs(grpc::CallbackServerContext* context,
                                                           const v1::ListRenderJobsRequest* request,
                                                           v1::ListRenderJobsResponse* response) {
  return entrance_.Unary("ListRenderJobs", context, [&](const CallerRef& caller) {
    return service::ListRenderJobs(*jobs_, engine_.limits, context, caller, request, response);
  });
}

grpc::ServerWriteReactor<v1::WatchRenderJobResponse>* RenderJobService::WatchRenderJob(
    grpc::CallbackServerContext* context, const v1::WatchRenderJobRequest* request) {
  return entrance_.Stream<grpc::ServerWriteReactor<v1::WatchRenderJobResponse>>(
      "WatchRenderJob", context, [&](CallerRef caller) {
        return service::WatchRenderJob(*jobs_, engine_.limits, context, std::move(caller), request);
      });
}

grpc::ServerUnaryReactor* RenderJobService::CancelRenderJob(
    grpc::CallbackServerContext* context, const v1::CancelRenderJobRequest* request,
    v1::CancelRenderJobResponse* response) {
  return entrance_.Unary("CancelRenderJob", context, [&](const CallerRef& caller) {
    return service::CancelRenderJob(*jobs_, engine_.limits, context, caller, request, response);
  });
}

grpc::ServerWriteReactor<v1::FetchRenderResultResponse>* RenderJobService::FetchRenderResult(
    grpc::CallbackServerContext* context, const v1::FetchRenderResultRequest* request) {
  return entrance_.Stream<grpc::ServerWriteReactor<v1::FetchRenderResultResponse>>(
      "FetchRenderResult", context, [&](CallerRef caller) {
        return service::FetchRenderResult(*jobs_, {reading_, calls_, open_}, engine_.limits,
                                          context, std::move(caller), request);
      });
}

}  // namespace thunderhead::service
