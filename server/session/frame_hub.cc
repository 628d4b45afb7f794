#include "session/frame_hub.h"

#include <algorithm>
#include <utility>
#include "telemetry/metrics.h"

namespace thunderhead::session {

using telemetry::Counted;
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

FrameHub::FrameHub(std::function<void()> on_demand, std::function<void()> on_wait)
    : on_demand_(std::move(on_demand)), on_wait_(std::move(on_wait)) {}

PublishedFrame::PublishedFrame(EncodedFrame full, ReduceFrame reduce)
    : reduce_(std::move(reduce)), tiers_{std::make_shared<const EncodedFrame>(std::move(full))} {}

std::shared_ptr<const EncodedFrame> PublishedFrame::At(int tier) {
  const std::lock_guard lock(mutex_);
  auto& frame = tiers_[static_cast<std::size_t>(tier)];
  if (frame == nullptr && reduce_ == nullptr) frame = tiers_[0];
  if (frame == nullptr) frame = std::make_shared<const EncodedFrame>(reduce_(Full(), tier));
  return frame;
}

absl::StatusOr<std::uint64_t> FrameHub::Join(std::shared_ptr<Viewer> viewer,
                                             const ViewerWants& wants) {
  std::uint64_t id = 0;
  {
    const std::lock_guard lock(mutex_);
    if (!closed_because_.ok()) return closed_because_;
    while (id == 0 || watches_.contains(id)) {
      id = (static_cast<std::uint64_t>(random_()) << 32) | random_();
    }
    watches_[id].viewer = std::move(viewer);
    watches_[id].wants = wants;
  }
  on_demand_();
  return id;
}

void FrameHub::SetWants(std::uint64_t viewer_id, const ViewerWants& wants) {
  const std::lock_guard lock(mutex_);
  const auto found = watches_.find(viewer_id);
  if (found == watches_.end() || found->second.wants == wants) return;
  found->second.wants = wants;
  found->second.waits_until.reset();
  // The newest picture again if it is too small now.
  if (frame_ != nullptr && TierFor(found->second, frame_->Full()) < found->second.last_tier) {
    found->second.last_sequence = 0;
  }
}

void FrameHub::Leave(std::uint64_t viewer_id) {
  {
    const std::lock_guard lock(mutex_);
    watches_.erase(viewer_id);
  }
  on_demand_();
}

int FrameHub::TierFor(const Watch& watch, const EncodedFrame& frame) {
  const int for_window = TierForWindow(frame.width_px, watch.wants.window_width_px);
  const bool reduced = watch.wants.adapts && !frame.refined;
  return reduced ? std::max(for_window, watch.link.tier()) : for_window;
}

bool FrameHub::IsReady(const Watch& watch, Time now) {
  return watch.in_flight.size() < kMaxInFlight &&
         (!watch.waits_until.has_value() || now >= *watch.waits_until);
}

bool FrameHub::HasFrameFor(const Watch& watch, Time now) const {
  return IsReady(watch, now) && frame_ != nullptr && frame_->Full().sequence > watch.last_sequence;
}

bool FrameHub::HasFor(const Watch& watch, Time now) const {
  return HasFrameFor(watch, now) || (problem_.has_value() && problem_count_ > watch.last_problem);
}

std::optional<FrameEvent> FrameHub::Take(std::uint64_t viewer_id, Time now) {
  std::shared_ptr<PublishedFrame> frame;
  int tier = 0;
  bool waits = false;
  {
    const std::lock_guard lock(mutex_);
    const auto found = watches_.find(viewer_id);
    if (found == watches_.end() || !closed_because_.ok()) return std::nullopt;
    Watch& watch = found->second;
    if (HasFrameFor(watch, now)) {
      frame = frame_;
      tier = TierFor(watch, frame->Full());
      const EncodedFrame& full = frame->Full();
      // A viewer who has just come has missed nothing.
      const bool has_had_any = watch.last_sequence > 0;
      if (has_had_any) Counted().frames_skipped.Add(full.sequence - watch.last_sequence - 1);
      const bool first = has_had_any && full.scene_revision > watch.last_revision;
      watch.last_tier = tier;
      watch.last_sequence = full.sequence;
      watch.last_revision = full.scene_revision;
      watch.in_flight.push_back(
          {watch.last_sequence, now, !full.refined, first ? full.changed_at : std::nullopt});
      if (watch.wants.frames_per_second > 0.0) {
        constexpr double kFewest_per_s = 0.1;
        const std::chrono::duration<double> pause(
            1.0 / std::max(watch.wants.frames_per_second, kFewest_per_s));
        watch.waits_until = now + std::chrono::duration_cast<Time::duration>(pause);
        waits = true;
      }
    } else if (problem_.has_value() && problem_count_ > watch.last_problem) {
      watch.last_problem = problem_count_;
      return *problem_;
    } else {
      return std::nullopt;
    }
  }
  if (waits) on_wait_();
  // Without the lock, as a tier that nobody wanted before is encoded now.
  std::shared_ptr<const EncodedFrame> sent = frame->At(tier);
  Counted().frames_sent.Add();
  Counted().frame_bytes_sent.Add(sent->jpeg.size());
  return sent;
}

bool FrameHub::Acknowledge(std::uint64_t viewer_id, std::uint64_t sequence, Time now) {
  std::shared_ptr<Viewer> viewer;
  bool became_ready = false;
  {
    const std::lock_guard lock(mutex_);
    const auto found = watches_.find(viewer_id);
    if (found == watches_.end()) return false;
    Watch& watch = found->second;
    auto& in_flight = watch.in_flight;
    const bool was_full = in_flight.size() >= kMaxInFlight;
    while (!in_flight.empty() && in_flight.front().sequence <= sequence) {
      if (const auto changed_at = in_flight.front().changed_at; changed_at.has_value()) {
        Counted().update_to_frame.Observe(std::chrono::duration<double>(now - *changed_at).count());
      }
      if (in_flight.front().moving) watch.link.Acknowledged(now, in_flight.front().at);
      in_flight.pop_front();
    }
    became_ready = was_full && in_flight.size() < kMaxInFlight;
    if (HasFor(watch, now)) viewer = watch.viewer;
  }
  if (viewer != nullptr) viewer->Wake();
  if (became_ready) on_demand_();
  return true;
}

std::optional<FrameHub::Time> FrameHub::WakeWaiting(Time now) {
  std::vector<std::shared_ptr<Viewer>> woken;
  std::optional<Time> next;
  {
    const std::lock_guard lock(mutex_);
    for (auto& [id, watch] : watches_) {
      if (!watch.waits_until.has_value()) continue;
      if (now >= *watch.waits_until) {
        watch.waits_until.reset();
        woken.push_back(watch.viewer);
      } else {
        next = std::min(next.value_or(*watch.waits_until), *watch.waits_until);
      }
    }
  }
  for (const auto& viewer : woken) viewer->Wake();
  if (!woken.empty()) on_demand_();
  return next;
}

void FrameHub::Publish(EncodedFrame frame, ReduceFrame reduce) {
  std::array<bool, kTiers> wanted{};
  {
    const std::lock_guard lock(mutex_);
    frame.sequence = ++frame_count_;
    for (const auto& [id, watch] : watches_) {
      wanted[static_cast<std::size_t>(TierFor(watch, frame))] = true;
    }
  }
  const std::uint64_t scene_revision = frame.scene_revision;
  const auto published = std::make_shared<PublishedFrame>(std::move(frame), std::move(reduce));
  for (int tier = 0; tier < kTiers; ++tier) {
    if (wanted[static_cast<std::size_t>(tier)]) published->At(tier);
  }
  {
    const std::lock_guard lock(mutex_);
    if (problem_.has_value() && problem_->scene_revision <= scene_revision) problem_.reset();
    frame_ = published;
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

int FrameHub::ViewerCount() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(watches_.size());
}

bool FrameHub::HasViewers() const {
  const std::lock_guard lock(mutex_);
  return !watches_.empty();
}

bool FrameHub::HasReadyViewer() const {
  const Time now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  return std::any_of(watches_.begin(), watches_.end(),
                     [now](const auto& entry) { return IsReady(entry.second, now); });
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
