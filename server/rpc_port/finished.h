// The reactors of calls that finish at once or after one piece of work. They report refusals to the
// audit log.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <memory>
#include <utility>

#include "absl/status/status.h"
#include "access/access_control.h"
#include "base/executor.h"
#include "base/guarded.h"
#include "rpc_port/answer.h"
#include "rpc_port/port_limits.h"
#include "rpc_port/status_table.h"

namespace thunderhead::rpc_port {

// Refuses a call without writing an entry to the audit log. It is used if the access control
// refused the call, or if the handler has already written the entry.
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

inline grpc::ServerUnaryReactor* Finished(const PortLimits& limits,
                                          grpc::CallbackServerContext* context,
                                          const std::shared_ptr<const access::Caller>& caller,
                                          const absl::Status& status,
                                          const google::protobuf::Message& response) {
  caller->ReportRefusal(status);
  auto* const answer = new Answer(context, limits, caller, response);
  answer->Give(status);
  return answer;
}

// Finishes with the result of `work`. The executor runs it on one of its threads, and shares them
// fairly between callers. If the caller has cancelled the call by then, `work` is skipped. gRPC
// keeps the call's objects alive until the call finishes.
template <typename Work>
grpc::ServerUnaryReactor* FinishedBy(base::Executor& executor, const PortLimits& limits,
                                     grpc::CallbackServerContext* context,
                                     const std::shared_ptr<const access::Caller>& caller,
                                     const google::protobuf::Message& response, Work work) {
  auto* const answer = new Answer(context, limits, caller, response);
  executor.Submit(caller->identity().name, [context, caller, answer,
                                            work = std::move(work)](const absl::Status& status) {
    const bool abandoned = context->IsCancelled();
    const absl::Status outcome = abandoned     ? absl::CancelledError("the call was cancelled")
                                 : status.ok() ? base::Guarded(work)
                                               : status;
    caller->ReportRefusal(outcome);
    answer->Give(outcome);
  });
  return answer;
}

// A refused stream of any kind. The first constructor is for streams that the access control
// refused, the second for refusals by a handler. The object deletes itself when gRPC calls OnDone.
template <typename Reactor>
class RefusedStream final : public Reactor {
 public:
  explicit RefusedStream(const absl::Status& why) { this->Finish(ToGrpcStatus(why)); }
  RefusedStream(const access::Caller& caller, const absl::Status& why) : RefusedStream(why) {
    caller.ReportRefusal(why);
  }
  void OnDone() override { delete this; }
};

}  // namespace thunderhead::rpc_port
