#include "service/render_job_service.h"

#include <utility>

#include "base/error_details.h"
#include "base/status.h"
#include "service/admission.h"
#include "service/finished.h"
#include "service/render_job_handlers.h"

namespace thunderhead::service {
namespace {

using access::CallKind;

// Whether the caller may, and whether there are jobs at all.
CallerOr AdmitToJobs(access::Door& door, const grpc::CallbackServerContext& context,
                     const char* method, CallKind kind, const jobs::Jobs* jobs) {
  THUNDERHEAD_ASSIGN_OR_RETURN(auto caller, Admit(door, context, method, kind));
  if (jobs != nullptr) return caller;
  return base::WithDetails(
      absl::FailedPreconditionError("this server keeps no render jobs; whoever runs it may start "
                                    "it with --state FOLDER, or --jobs-folder"),
      {.reason = "NO_JOBS_HERE"});
}

}  // namespace

grpc::ServerUnaryReactor* RenderJobService::CreateRenderJob(
    grpc::CallbackServerContext* context, const v1::CreateRenderJobRequest* request,
    v1::CreateRenderJobResponse* response) {
  const CallerOr caller = AdmitToJobs(door_, *context, "CreateRenderJob", CallKind::kUnary, jobs_);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::CreateRenderJob(engine_, *jobs_, context, *caller, request, response);
}

grpc::ServerUnaryReactor* RenderJobService::GetRenderJob(grpc::CallbackServerContext* context,
                                                         const v1::GetRenderJobRequest* request,
                                                         v1::GetRenderJobResponse* response) {
  const CallerOr caller = AdmitToJobs(door_, *context, "GetRenderJob", CallKind::kUnary, jobs_);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::GetRenderJob(*jobs_, context, *caller, request, response);
}

grpc::ServerUnaryReactor* RenderJobService::ListRenderJobs(grpc::CallbackServerContext* context,
                                                           const v1::ListRenderJobsRequest* request,
                                                           v1::ListRenderJobsResponse* response) {
  const CallerOr caller = AdmitToJobs(door_, *context, "ListRenderJobs", CallKind::kUnary, jobs_);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::ListRenderJobs(*jobs_, context, *caller, request, response);
}

grpc::ServerWriteReactor<v1::WatchRenderJobResponse>* RenderJobService::WatchRenderJob(
    grpc::CallbackServerContext* context, const v1::WatchRenderJobRequest* request) {
  CallerOr caller = AdmitToJobs(door_, *context, "WatchRenderJob", CallKind::kStream, jobs_);
  if (!caller.ok()) {
    return new RefusedStream<grpc::ServerWriteReactor<v1::WatchRenderJobResponse>>(caller.status());
  }
  return service::WatchRenderJob(*jobs_, *std::move(caller), request);
}

grpc::ServerUnaryReactor* RenderJobService::CancelRenderJob(
    grpc::CallbackServerContext* context, const v1::CancelRenderJobRequest* request,
    v1::CancelRenderJobResponse* response) {
  const CallerOr caller = AdmitToJobs(door_, *context, "CancelRenderJob", CallKind::kUnary, jobs_);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::CancelRenderJob(*jobs_, context, *caller, request, response);
}

grpc::ServerWriteReactor<v1::FetchRenderResultResponse>* RenderJobService::FetchRenderResult(
    grpc::CallbackServerContext* context, const v1::FetchRenderResultRequest* request) {
  CallerOr caller = AdmitToJobs(door_, *context, "FetchRenderResult", CallKind::kStream, jobs_);
  if (!caller.ok()) {
    return new RefusedStream<grpc::ServerWriteReactor<v1::FetchRenderResultResponse>>(
        caller.status());
  }
  return service::FetchRenderResult(*jobs_, reading_, *std::move(caller), request);
}

}  // namespace thunderhead::service
