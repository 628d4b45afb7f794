// RenderJobService as gRPC calls it. It checks access for each call and dispatches the call to its
// handler (render_job_handlers.h).
#pragma once

#include "access/access_control.h"
#include "base/executor.h"
#include "base/timed_calls.h"
#include "jobs/jobs.h"
#include "rpc_port/admission.h"
#include "service/engine/engine.h"
#include "service/jobs/job_files.h"
#include "thunderhead/v1/job.grpc.pb.h"

namespace thunderhead::service {

class RenderJobService final : public v1::RenderJobService::CallbackService {
 public:
  // `jobs` is null if the server keeps no jobs. All arguments must outlive this object. Fetching a
  // result fails if its storage does not respond within `files.patience`.
  RenderJobService(Engine& engine, access::AccessControl& access_control,
                   rpc_port::ConnectionCalls& calls, jobs::Jobs* jobs, const JobFiles& files);

  grpc::ServerUnaryReactor* CreateRenderJob(grpc::CallbackServerContext* context,
                                            const v1::CreateRenderJobRequest* request,
                                            v1::CreateRenderJobResponse* response) override;
  grpc::ServerUnaryReactor* GetRenderJob(grpc::CallbackServerContext* context,
                                         const v1::GetRenderJobRequest* request,
                                         v1::GetRenderJobResponse* response) override;
  grpc::ServerUnaryReactor* ListRenderJobs(grpc::CallbackServerContext* context,
                                           const v1::ListRenderJobsRequest* request,
                                           v1::ListRenderJobsResponse* response) override;
  grpc::ServerWriteReactor<v1::WatchRenderJobResponse>* WatchRenderJob(
      grpc::CallbackServerContext* context, const v1::WatchRenderJobRequest* request) override;
  grpc::ServerUnaryReactor* CancelRenderJob(grpc::CallbackServerContext* context,
                                            const v1::CancelRenderJobRequest* request,
                                            v1::CancelRenderJobResponse* response) override;
  grpc::ServerWriteReactor<v1::FetchRenderResultResponse>* FetchRenderResult(
      grpc::CallbackServerContext* context, const v1::FetchRenderResultRequest* request) override;

  // Ends the reading of results and refuses further reads.
  void Stop() { reading_.Stop(); }

 private:
  // One identity may use two of these threads, so that one thread is left for others. A large file
  // on a slow disk then delays few callers.
  static constexpr int kReadingThreads = 3;

  Engine& engine_;
  jobs::Jobs* const jobs_;
  const rpc_port::Entrance entrance_;
  const OpenResult open_;
  base::Executor reading_;
  base::TimedCalls calls_;  // requests to the storage of results
};

}  // namespace thunderhead::service
