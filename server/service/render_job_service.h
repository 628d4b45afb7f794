// The service of render jobs as gRPC calls it: asks the door about every call, and dispatches it to
// its handler.
#pragma once

#include <chrono>

#include "access/door.h"
#include "base/executor.h"
#include "base/patient_calls.h"
#include "jobs/jobs.h"
#include "service/admission.h"
#include "service/engine.h"
#include "thunderhead/v1/job.grpc.pb.h"

namespace thunderhead::service {

class RenderJobService final : public v1::RenderJobService::CallbackService {
 public:
  // `jobs` is null where the server keeps none; all must outlive this. A result whose storage does
  // not answer within `patience` is not fetched.
  RenderJobService(Engine& engine, access::Door& door, ConnectionCalls& calls, jobs::Jobs* jobs,
                   std::chrono::milliseconds patience);

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

  // Ends the reading of results; further ones are refused.
  void Stop() { reading_.Stop(); }

 private:
  // Two for one identity, and one for others, so that a large file on a slow disk holds up few.
  static constexpr int kReadingThreads = 3;

  Engine& engine_;
  jobs::Jobs* const jobs_;
  const Entrance entrance_;
  base::Executor reading_;
  base::PatientCalls calls_;  // to the storage of results
};

}  // namespace thunderhead::service
