// Cancels a call whose client does not receive a message in time. gRPC itself would wait
// indefinitely for a client that answers pings but grants no HTTP/2 flow-control window.
#pragma once

#include <grpcpp/alarm.h>
#include <grpcpp/server_context.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>

#include "base/time_source.h"
#include "rpc_port/port_limits.h"

namespace thunderhead::rpc_port {

class DeliveryDeadline {
 public:
  // `limits` must outlive this object.
  DeliveryDeadline(grpc::CallbackServerContext* context, const PortLimits& limits)
      : limits_(limits), call_(std::make_shared<Call>(context, *limits.time)) {}
  DeliveryDeadline(const DeliveryDeadline&) = delete;
  DeliveryDeadline& operator=(const DeliveryDeadline&) = delete;
  // Stops checking. The call must have ended, and this object must be destroyed before OnDone
  // returns.
  ~DeliveryDeadline();

  // Starts the deadline for a message of that many bytes. The deadline runs until Taken(). This
  // function is cheap enough to call for each frame.
  void Begin(std::size_t bytes);
  void Taken();

 private:
  using Clock = std::chrono::steady_clock;

  // The state that the alarm uses, which may outlive the call. The alarm is not set again for each
  // message. When it fires, it checks the deadline of the message that is being written.
  struct Call : std::enable_shared_from_this<Call> {
    Call(grpc::CallbackServerContext* of, const base::TimeSource& by) : context(of), time(by) {}
    void SetAlarm(Clock::time_point at);
    void Look();

    // The mutex is recursive because TryCancel may end the call on the same thread.
    std::recursive_mutex mutex;
    grpc::CallbackServerContext* context;  // null after the call has ended
    const base::TimeSource& time;
    std::optional<Clock::time_point> due;  // empty while no message is being written
    std::optional<grpc::Alarm> alarm;
    Clock::time_point rings_at;
  };

  const PortLimits& limits_;
  const std::shared_ptr<Call> call_;
};

}  // namespace thunderhead::rpc_port
