#include "service/delivery_deadline.h"

#include <chrono>

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

void DeliveryDeadline::Begin(std::size_t bytes) {
  int write = 0;
  {
    const std::lock_guard lock(call_->mutex);
    write = ++call_->writes;
  }
  alarm_.emplace();
  alarm_->Set(std::chrono::system_clock::now() + DeliveryTime(limits_, bytes),
              [call = call_, write](bool is_over) {
                if (!is_over) return;
                const std::lock_guard lock(call->mutex);
                if (call->context != nullptr && call->writes == write) call->context->TryCancel();
              });
}

}  // namespace thunderhead::service
