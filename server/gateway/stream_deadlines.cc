#include "gateway/stream_deadlines.h"

#include <algorithm>
#include <boost/system/error_code.hpp>
#include <utility>

namespace thunderhead::gateway {

using boost::system::error_code;

void StreamDeadlines::Begin(Way way) {
  Pending(way) = next_;
  Arm();
}

void StreamDeadlines::Arm() {
  const TimePoint end = *std::ranges::min_element(pending_);
  // If the timer already waits for an earlier deadline, it checks this deadline when it fires.
  if (end >= armed_for_) return;
  armed_for_ = end;
  timer_.expires_at(time_.LookAgainAt(end));
  timer_.async_wait([weak = weak_from_this()](error_code cancelled) {
    if (const auto self = weak.lock(); self != nullptr && !cancelled) self->Look();
  });
}

void StreamDeadlines::Look() {
  armed_for_ = kNever;
  if (*std::ranges::min_element(pending_) > time_.Now()) {
    Arm();
    return;
  }
  error_code ignored;
  socket_.close(ignored);
}

}  // namespace thunderhead::gateway
