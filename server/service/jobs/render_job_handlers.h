// Declares one handler for each rpc of RenderJobService. Each is defined in the file that is named
// after the rpc.
#pragma once

#include <grpcpp/support/server_callback.h>

#include "base/executor.h"
#include "base/timed_calls.h"
#include "jobs/jobs.h"
#include "service/engine/engine.h"
#include "service/engine/limits.h"
#include "service/jobs/job_files.h"
#include "thunderhead/v1/job.pb.h"

namespace thunderhead::service {

grpc::ServerUnaryReactor* CreateRenderJob(Engine& engine, jobs::Jobs& jobs,
                                          grpc::CallbackServerContext* context,
                                          const CallerRef& caller,
                                          const v1::CreateRenderJobRequest* request,
                                          v1::CreateRenderJobResponse* response);
grpc::ServerUnaryReactor* GetRenderJob(jobs::Jobs& jobs, const Limits& limits,
                                       grpc::CallbackServerContext* context,
                                       const CallerRef& caller,
                                       const v1::GetRenderJobRequest* request,
                                       v1::GetRenderJobResponse* response);
grpc::ServerUnaryReactor* ListRenderJobs(jobs::Jobs& jobs, const Limits& limits,
                                         grpc::CallbackServerContext* context,
                                         const CallerRef& caller,
                                         const v1::ListRenderJobsRequest* request,
                                         v1::ListRenderJobsResponse* response);
grpc::ServerWriteReactor<v1::WatchRenderJobResponse>* WatchRenderJob(
    jobs::Jobs& jobs, const Limits& limits, grpc::CallbackServerContext* context, CallerRef caller,
    const v1::WatchRenderJobRequest* request);
grpc::ServerUnaryReactor* CancelRenderJob(jobs::Jobs& jobs, const Limits& limits,
                                          grpc::CallbackServerContext* context,
                                          const CallerRef& caller,
                                          const v1::CancelRenderJobRequest* request,
                                          v1::CancelRenderJobResponse* response);

// The resources with which FetchRenderResult reads result files: separate threads, calls to the
// storage with a timeout, and the function that opens a file.
struct ResultReading {
  base::Executor& threads;
  base::TimedCalls& calls;
  OpenResult open;
};
grpc::ServerWriteReactor<v1::FetchRenderResultResponse>* FetchRenderResult(
    jobs::Jobs& jobs, const ResultReading& reading, const Limits& limits,
    grpc::CallbackServerContext* context, CallerRef caller,
    const v1::FetchRenderResultRequest* request);

}  // namespace thunderhead::service
