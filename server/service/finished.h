// The reactors of calls that finish at once, or with one piece of work. Refusals are written to the
// audit here.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <memory>
#include <utility>

#include "absl/status/status.h"
#include "access/door.h"
#include "base/guarded.h"
#include "service/answer.h"
#include "service/engine.h"
#include "service/limits.h"
#include "service/status_table.h"

namespace thunderhead::service {

// Refuses without the audit: calls that the door has refused, or whose handler wrote the line.
inline grpc::ServerUnaryReactor* Refused(grpc::CallbackServerContext* context,
                                         const absl::Status& why) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(ToGrpcStatus(why));
  return reactor;
}

inline grpc::ServerUnaryReactor* Refused(grpc::CallbackServerContext* context,
                                         const access::Caller& caller, const absl::Status& why) {
  caller.ReportRefusal(why);
  return Refused(context, why);
}

inline grpc::ServerUnaryReactor* Finished(const Limits& limits,
                                          grpc::CallbackServerContext* context,
                                          const std::shared_ptr<const access::Caller>& caller,
                                          const absl::Status& status,
                                          const google::protobuf::Message& response) {
  caller->ReportRefusal(status);
  auto* const answer = new Answer(context, limits, caller, response);
  answer->Give(status);
  return answer;
}

// Finishes with what `work` gives on a thread of the executor, in the caller's turn; not begun for
// a caller who has gone. What gRPC keeps of the call lives until then.
template <typename Work>
grpc::ServerUnaryReactor* FinishedBy(Engine& engine, grpc::CallbackServerContext* context,
                                     const std::shared_ptr<const access::Caller>& caller,
                                     const google::protobuf::Message& response, Work work) {
  auto* const answer = new Answer(context, engine.limits, caller, response);
  engine.executor.Submit(caller->identity().name, [context, caller, answer, work = std::move(work)](
                                                      const absl::Status& status) {
    const bool abandoned = context->IsCancelled();
    const absl::Status outcome = abandoned     ? absl::CancelledError("the call was cancelled")
                                 : status.ok() ? base::Guarded(work)
                                               : status;
    caller->ReportRefusal(outcome);
    answer->Give(outcome);
  });
  return answer;
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
