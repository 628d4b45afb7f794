// The reactors of calls that finish at once, or with one piece of work. Refusals are written to the
// audit here.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <memory>
#include <utility>

#include "absl/status/status.h"
#include "access/door.h"
#include "base/executor.h"
#include "base/out_of_memory.h"
#include "service/status_table.h"

namespace thunderhead::service {

// Answers without the audit: of calls that the door has refused, or whose handler wrote the line.
inline grpc::ServerUnaryReactor* Answered(grpc::CallbackServerContext* context,
                                          const absl::Status& status) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(ToGrpcStatus(status));
  return reactor;
}

inline grpc::ServerUnaryReactor* Finished(grpc::CallbackServerContext* context,
                                          const access::Caller& caller,
                                          const absl::Status& status) {
  caller.ReportRefusal(status);
  return Answered(context, status);
}

// Finishes with what `work` gives on a thread of the executor, in the caller's turn; not begun for
// a caller who has gone. What gRPC keeps of the call lives until then.
template <typename Work>
grpc::ServerUnaryReactor* FinishedBy(base::Executor& executor, grpc::CallbackServerContext* context,
                                     const std::shared_ptr<const access::Caller>& caller,
                                     Work work) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  executor.Submit(caller->identity().name, [context, caller, reactor,
                                            work = std::move(work)](const absl::Status& status) {
    const bool abandoned = context->IsCancelled();
    const absl::Status outcome = abandoned     ? absl::CancelledError("the call was cancelled")
                                 : status.ok() ? base::OrOutOfMemory(work)
                                               : status;
    caller->ReportRefusal(outcome);
    reactor->Finish(ToGrpcStatus(outcome));
  });
  return reactor;
}

// A stream that is refused, of any kind; the first is for those that the door has refused. Deletes
// itself when gRPC calls OnDone.
template <typename Reactor>
class RefusedStream final : public Reactor {
 public:
  explicit RefusedStream(const absl::Status& why) { this->Finish(ToGrpcStatus(why)); }
  RefusedStream(const access::Caller& caller, const absl::Status& why) : RefusedStream(why) {
    caller.ReportRefusal(why);
  }
  void OnDone() override { delete this; }
};

}  // namespace thunderhead::service
