#include "rpc_port/delivery_deadline.h"

#include "rpc_port/alarm_time.h"

namespace thunderhead::rpc_port {

DeliveryDeadline::~DeliveryDeadline() {
  const std::lock_guard lock(call_->mutex);
  call_->context = nullptr;
  call_->alarm.reset();
}

void DeliveryDeadline::Begin(std::size_t bytes) {
  const Clock::time_point due = limits_.time->Now() + DeliveryTime(limits_, bytes);
  const std::lock_guard lock(call_->mutex);
  call_->due = due;
  if (!call_->alarm.has_value() || due < call_->rings_at) call_->SetAlarm(due);
}

void DeliveryDeadline::Taken() {
  const std::lock_guard lock(call_->mutex);
  call_->due.reset();
}

void DeliveryDeadline::Call::SetAlarm(Clock::time_point at) {
  rings_at = at;
  alarm.emplace();
  alarm->Set(AlarmTime(time, at), [self = shared_from_this()](bool rings) {
    if (rings) self->Look();
  });
}

void DeliveryDeadline::Call::Look() {
  const std::lock_guard lock(mutex);
  if (context == nullptr) return;
  if (!due.has_value()) return alarm.reset();
  if (*due > time.Now()) return SetAlarm(*due);
  context->TryCancel();
}

}  // namespace thunderhead::rpc_port
