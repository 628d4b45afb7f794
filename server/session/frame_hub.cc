#include "session/frame_hub.h"

#include <algorithm>
#include <utility>

namespace thunderhead::session {
namespace {

Problem::Code CodeOf(absl::StatusCode code) {
  switch (code) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kOutOfRange:
      return Problem::Code::kScene;
    case absl::StatusCode::kResourceExhausted:
    case absl::StatusCode::kUnavailable:
      return Problem::Code::kBusy;
    default:
      return Problem::Code::kInternal;
  }
}

}  // namespace

Problem ProblemOf(std::uint64_t scene_revision, const absl::Status& why) {
  return {scene_revision, std::string(why.message()), CodeOf(why.code())};
}

Problem UnreadableStorm(std::uint64_t scene_revision, const absl::Status& why) {
  const bool gone = absl::IsNotFound(why);
  return {scene_revision, std::string(why.message()),
          gone ? Problem::Code::kStormGone : Problem::Code::kStormUnreadable};
}

FrameHub::FrameHub(std::function<void()> on_demand) : on_demand_(std::move(on_demand)) {}

absl::StatusOr<std::uint64_t> FrameHub::Join(std::shared_ptr<Viewer> viewer) {
  std::uint64_t id = 0;
  {
    const std::lock_guard lock(mutex_);
    if (!closed_because_.ok()) return closed_because_;
    id = ++viewer_count_;
    watches_[id].viewer = std::move(viewer);
  }
  on_demand_();
  return id;
}

void FrameHub::Leave(std::uint64_t viewer_id) {
  {
    const std::lock_guard lock(mutex_);
    watches_.erase(viewer_id);
  }
  on_demand_();
}

std::optional<FrameEvent> FrameHub::Take(std::uint64_t viewer_id) {
  const std::lock_guard lock(mutex_);
  const auto found = watches_.find(viewer_id);
  if (found == watches_.end() || !closed_because_.ok()) return std::nullopt;
  Watch& watch = found->second;
  if (HasFrameFor(watch)) {
    watch.last_sequence = frame_->sequence;
    watch.in_flight.push_back(frame_->sequence);
    return frame_;
  }
  if (problem_.has_value() && problem_count_ > watch.last_problem) {
    watch.last_problem = problem_count_;
    return *problem_;
  }
  return std::nullopt;
}

bool FrameHub::HasFrameFor(const Watch& watch) const {
  return watch.in_flight.size() < kMaxInFlight && frame_ != nullptr &&
         frame_->sequence > watch.last_sequence;
}

bool FrameHub::HasFor(const Watch& watch) const {
  return HasFrameFor(watch) || (problem_.has_value() && problem_count_ > watch.last_problem);
}

bool FrameHub::Acknowledge(std::uint64_t viewer_id, std::uint64_t sequence) {
  std::shared_ptr<Viewer> viewer;
  bool became_ready = false;
  {
    const std::lock_guard lock(mutex_);
    const auto found = watches_.find(viewer_id);
    if (found == watches_.end()) return false;
    auto& in_flight = found->second.in_flight;
    const bool was_full = in_flight.size() >= kMaxInFlight;
    while (!in_flight.empty() && in_flight.front() <= sequence) in_flight.pop_front();
    became_ready = was_full && in_flight.size() < kMaxInFlight;
    if (HasFor(found->second)) viewer = found->second.viewer;
  }
  if (viewer != nullptr) viewer->Wake();
  if (became_ready) on_demand_();
  return true;
}

void FrameHub::Publish(EncodedFrame frame) {
  {
    const std::lock_guard lock(mutex_);
    frame.sequence = ++frame_count_;
    if (problem_.has_value() && problem_->scene_revision <= frame.scene_revision) problem_.reset();
    frame_ = std::make_shared<const EncodedFrame>(std::move(frame));
  }
  WakeAll();
}

void FrameHub::Publish(Problem problem) {
  {
    const std::lock_guard lock(mutex_);
    ++problem_count_;
    problem_ = std::move(problem);
  }
  WakeAll();
}

void FrameHub::Close(const absl::Status& why) {
  {
    const std::lock_guard lock(mutex_);
    if (!closed_because_.ok()) return;
    closed_because_ = why;
  }
  WakeAll();
}

absl::Status FrameHub::ClosedBecause() const {
  const std::lock_guard lock(mutex_);
  return closed_because_;
}

bool FrameHub::HasViewers() const {
  const std::lock_guard lock(mutex_);
  return !watches_.empty();
}

bool FrameHub::HasReadyViewer() const {
  const std::lock_guard lock(mutex_);
  return std::any_of(watches_.begin(), watches_.end(), [](const auto& entry) {
    return entry.second.in_flight.size() < kMaxInFlight;
  });
}

void FrameHub::WakeAll() {
  std::vector<std::shared_ptr<Viewer>> viewers;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, watch] : watches_) viewers.push_back(watch.viewer);
  }
  for (const auto& viewer : viewers) viewer->Wake();
}

}  // namespace thunderhead::session
