#include "thunderhead_client/outbox.h"

#include <algorithm>
#include <utility>

namespace thunderhead::client {
namespace {

constexpr std::size_t kMaxOrdered = 256;
// Interval between two cameras and between two pointers, because the server accepts 30 of each a
// second.
constexpr std::chrono::milliseconds kPace{34};

}  // namespace

bool Outbox::Send(v1::InteractRequest request) {
  if (ordered_.size() >= kMaxOrdered) return false;
  ordered_.push_back(std::move(request));
  return true;
}

void Outbox::Acknowledge(const v1::Acknowledgement& acknowledgement) {
  auto& slot = acknowledgement.own_view() ? own_acknowledgement_ : acknowledgement_;
  const bool lost = slot && slot->video_lost();
  slot = acknowledgement;
  if (lost) slot->set_video_lost(true);
}

std::optional<v1::InteractRequest> Outbox::Next(TimePoint now) {
  v1::InteractRequest request;
  for (auto* const slot : {&acknowledgement_, &own_acknowledgement_}) {
    if (!*slot) continue;
    *request.mutable_acknowledge() = *std::exchange(*slot, std::nullopt);
    return request;
  }
  if (!ordered_.empty()) {
    request = std::move(ordered_.front());
    ordered_.pop_front();
    return request;
  }
  if (window_) {
    *request.mutable_window() = *std::exchange(window_, std::nullopt);
    return request;
  }
  if (camera_ && now >= camera_due_) {
    *request.mutable_move_camera()->mutable_camera() = *std::exchange(camera_, std::nullopt);
    camera_due_ = now + kPace;
    return request;
  }
  if (point_ && now >= point_due_) {
    *request.mutable_point() = *std::exchange(point_, std::nullopt);
    point_due_ = now + kPace;
    return request;
  }
  return {};
}

std::optional<Outbox::TimePoint> Outbox::WakeAt() const {
  std::optional<TimePoint> wake;
  if (camera_) wake = camera_due_;
  if (point_) wake = wake ? std::min(*wake, point_due_) : point_due_;
  return wake;
}

}  // namespace thunderhead::client
