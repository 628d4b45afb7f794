// Cancels a call whose client does not take in time what it asked for. gRPC itself would wait for
// ever for one that grants no room for it (HTTP/2's flow control) and goes on answering pings.
#pragma once

#include <grpcpp/alarm.h>
#include <grpcpp/server_context.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>

#include "base/time_source.h"
#include "service/limits.h"

namespace thunderhead::service {

class DeliveryDeadline {
 public:
  // `limits` must outlive it.
  DeliveryDeadline(grpc::CallbackServerContext* context, const Limits& limits)
      : limits_(limits), call_(std::make_shared<Call>(context, *limits.time)) {}
  DeliveryDeadline(const DeliveryDeadline&) = delete;
  DeliveryDeadline& operator=(const DeliveryDeadline&) = delete;
  // The call has ended: to be destroyed before OnDone returns.
  ~DeliveryDeadline();

  // The client has the time of so many bytes from now on for what is written next, until Taken().
  // Cheap enough for each frame.
  void Begin(std::size_t bytes);
  void Taken();

 private:
  using Clock = std::chrono::steady_clock;

  // State that the alarm may still use after the call has ended. The alarm is not set anew for each
  // message: when it rings, it looks when the one that is being written is due.
  struct Call : std::enable_shared_from_this<Call> {
    Call(grpc::CallbackServerContext* of, const base::TimeSource& by) : context(of), time(by) {}
    void SetAlarm(Clock::time_point at);
    void Look();

    // Recursive, as cancelling may end the call on the same thread.
    std::recursive_mutex mutex;
    grpc::CallbackServerContext* context;  // null: it has ended
    const base::TimeSource& time;
    std::optional<Clock::time_point> due;  // nothing: no message is being written
    std::optional<grpc::Alarm> alarm;
    Clock::time_point rings_at;
  };

  const Limits& limits_;
  const std::shared_ptr<Call> call_;
};

}  // namespace thunderhead::service
