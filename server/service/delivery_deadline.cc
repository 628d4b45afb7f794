#include "service/delivery_deadline.h"

namespace thunderhead::service {

DeliveryDeadline::~DeliveryDeadline() {
  const std::lock_guard lock(call_->mutex);
  call_->context = nullptr;
}

void DeliveryDeadline::Taken() {
  {
    const std::lock_guard lock(call_->mutex);
    ++call_->writes;
  }
  alarm_.reset();
}

void DeliveryDeadline::Begin(std::chrono::milliseconds time) {
  int write = 0;
  {
    const std::lock_guard lock(call_->mutex);
    write = ++call_->writes;
  }
  alarm_.emplace();
  alarm_->Set(std::chrono::system_clock::now() + time, [call = call_, write](bool is_over) {
    if (!is_over) return;
    const std::lock_guard lock(call->mutex);
    if (call->context != nullptr && call->writes == write) call->context->TryCancel();
  });
}

}  // namespace thunderhead::service
