// The reactors of calls that finish at once, or with one piece of work.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <utility>

#include "absl/status/status.h"
#include "base/executor.h"
#include "service/status_table.h"

namespace thunderhead::service {

inline grpc::ServerUnaryReactor* Finished(grpc::CallbackServerContext* context,
                                          const absl::Status& status) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(ToGrpcStatus(status));
  return reactor;
}

// Finishes with what `work` gives on a thread of the executor, which does not begin it for a caller
// who has gone. What gRPC keeps of the call lives until then.
template <typename Work>
grpc::ServerUnaryReactor* FinishedBy(base::Executor& executor, grpc::CallbackServerContext* context,
                                     Work work) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  executor.Submit([context, reactor, work = std::move(work)](const absl::Status& status) {
    const bool abandoned = context->IsCancelled();
    reactor->Finish(ToGrpcStatus(abandoned     ? absl::CancelledError("the call was cancelled")
                                 : status.ok() ? work()
                                               : status));
  });
  return reactor;
}

// A stream that is refused, of any kind. Deletes itself when gRPC calls OnDone.
template <typename Reactor>
class RefusedStream final : public Reactor {
 public:
  explicit RefusedStream(const absl::Status& why) { this->Finish(ToGrpcStatus(why)); }
  void OnDone() override { delete this; }
};

}  // namespace thunderhead::service
