#include "delivery/frame_hub.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "telemetry/metrics.h"

namespace thunderhead::delivery {
namespace {

using telemetry::Counted;

// Ranks the forms of a frame. A form with a larger value replaces one with a smaller value.
int Worth(const FrameForm& form) {
  int worth = kTiers - form.tier;
  if (form.kind == FrameForm::Kind::kJpeg) worth += kTiers;
  if (form.kind == FrameForm::Kind::kResting) worth += 2 * kTiers;
  return worth;
}

}  // namespace

FrameHub::FrameHub(std::function<void()> on_demand, std::function<void()> on_wait,
                   const base::TimeSource& time)
    : on_demand_(std::move(on_demand)), on_wait_(std::move(on_wait)), time_(time) {}

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
    // Step 0 of the estimate is full-size JPEG. The further steps are video in the tiers.
    if (TakesVideo(watches_[id])) watches_[id].link = LinkEstimate(1 + kTiers);
    SetLeastSteps(time_.Now());
  }
  on_demand_();
  return id;
}

void FrameHub::SetWants(std::uint64_t viewer_id, const ViewerWants& wants) {
  const std::lock_guard lock(mutex_);
  const auto found = watches_.find(viewer_id);
  if (found == watches_.end() || found->second.wants == wants) return;
  Watch& watch = found->second;
  watch.wants = wants;
  watch.waits_until.reset();
  SetLeastSteps(time_.Now());
  // If the viewer's picture is now too small, this lets the viewer take the newest frame again.
  if (frame_ != nullptr && IsTooSmall(watch, *frame_)) watch.last_sequence = 0;
}

bool FrameHub::IsTooSmall(const Watch& watch, const PublishedFrame& frame) {
  switch (watch.last_form.kind) {
    case FrameForm::Kind::kJpeg:
      return JpegTier(watch, frame) < watch.last_form.tier;
    case FrameForm::Kind::kResting:
      return TierForWindow(WidthOf(frame.Described()), watch.wants.window_width_px) <
             watch.last_form.tier;
    case FrameForm::Kind::kVideo:
      break;
  }
  // A viewer of video whose picture is too small is not sent the frame again. The next video
  // picture, or at rest a JPEG picture, follows soon and has the new size.
  return false;
}

void FrameHub::Leave(std::uint64_t viewer_id) {
  {
    const std::lock_guard lock(mutex_);
    watches_.erase(viewer_id);
    SetLeastSteps(time_.Now());
  }
  on_demand_();
}

bool FrameHub::TakesVideo(const Watch& watch) {
  return watch.wants.adapts && watch.wants.takes_video;
}

void FrameHub::SetLeastSteps(Time now) {
  const auto able = std::count_if(watches_.begin(), watches_.end(),
                                  [](const auto& entry) { return TakesVideo(entry.second); });
  for (auto& [id, watch] : watches_) {
    const bool at_once = watch.wants.saves_bytes || able >= kManyForVideo;
    if (TakesVideo(watch)) watch.link.SetLeast(at_once ? 1 : 0, now);
  }
}

int FrameHub::JpegTier(const Watch& watch, const PublishedFrame& frame) {
  const int for_window = TierForWindow(WidthOf(frame.Described()), watch.wants.window_width_px);
  const bool reduced = watch.wants.adapts && !frame.Rests();
  return reduced ? std::max(for_window, std::min(watch.link.step(), kTiers - 1)) : for_window;
}

std::optional<int> FrameHub::VideoTier(const Watch& watch, const PictureWidth& width) {
  if (!TakesVideo(watch) || watch.link.step() == 0) return std::nullopt;
  return std::max(TierForWindow(width, watch.wants.window_width_px), watch.link.step() - 1);
}

bool FrameHub::KeepsRestingFrame(const Watch& watch, const EncodedFrame& next, Time now) const {
  // Frames of the Monte Carlo reference come too fast to wait for a resting frame of each. For
  // other frames the wait is limited, because a busy machine may encode a resting frame late.
  if (next.refinement.has_value()) return false;
  if (resting_frame_due_since_.has_value() &&
      now - *resting_frame_due_since_ > kLongestForRestingFrame)
    return false;
  const int for_window = TierForWindow(WidthOf(next), watch.wants.window_width_px);
  return watch.wants.takes_resting_frames && watch.last_revision == next.scene_revision &&
         watch.last_form == FrameForm{FrameForm::Kind::kResting, for_window};
}

std::size_t FrameHub::MaxInFlight(const Watch& watch) {
  return watch.last_form.kind == FrameForm::Kind::kVideo ? watch.window.size() : kMaxInFlight;
}

bool FrameHub::IsReady(const Watch& watch, Time now) {
  return watch.in_flight.size() < MaxInFlight(watch) &&
         (!watch.waits_until.has_value() || now >= *watch.waits_until);
}

std::optional<FrameHub::Offer> FrameHub::VideoFor(const Watch& watch, const PublishedFrame& frame,
                                                  int tier) const {
  const FrameForm form{FrameForm::Kind::kVideo, tier};
  const std::uint64_t newest = frame.Described().sequence;
  const VideoPicture& picture = frame.Video(tier);
  if (picture.frame != nullptr && newest > watch.last_sequence &&
      watch.place.CanTake(tier, picture)) {
    return Offer{newest, form, picture};
  }
  // Offers the base picture that the viewer has missed. Without it, the viewer can decode no newer
  // picture.
  const VideoStream& stream = streams_[static_cast<std::size_t>(tier)];
  const VideoPicture& base = stream.NewestBase();
  // The base may be a key picture that no viewer requested, for example after a change of size.
  const std::uint64_t has = watch.place.BaseOf(tier);
  const bool missed = base.frame != nullptr && has != 0 && (base.needs == 0 || base.needs == has) &&
                      stream.NewestBaseSequence() > watch.last_sequence;
  if (missed) return Offer{stream.NewestBaseSequence(), form, base};
  return std::nullopt;
}

std::optional<FrameHub::Offer> FrameHub::OfferFor(const Watch& watch, PublishedFrame& frame,
                                                  Time now) const {
  const EncodedFrame& described = frame.Described();
  const bool is_new = described.sequence > watch.last_sequence;
  const auto if_wanted = [&](const FrameForm& form) -> std::optional<Offer> {
    const bool better = frame.Rests() && Worth(form) > Worth(watch.last_form);
    if (!is_new && !better) return std::nullopt;
    return Offer{described.sequence, form, {}};
  };
  const int for_window = TierForWindow(WidthOf(described), watch.wants.window_width_px);
  if (watch.wants.takes_resting_frames && frame.RestingFrame(for_window) != nullptr) {
    return if_wanted({FrameForm::Kind::kResting, for_window});
  }
  if (frame.RestingFrameFollows() && KeepsRestingFrame(watch, described, now)) return std::nullopt;
  const FrameForm jpeg{FrameForm::Kind::kJpeg, JpegTier(watch, frame)};
  const std::optional<int> video_tier = VideoTier(watch, WidthOf(described));
  if (!video_tier.has_value()) return if_wanted(jpeg);
  const bool awaits_resting_frame = watch.wants.takes_resting_frames && frame.RestingFrameFollows();
  if (frame.Rests() && !awaits_resting_frame) return if_wanted(jpeg);
  if (auto video = VideoFor(watch, frame, *video_tier); video.has_value()) return video;
  // The viewer gets small JPEG pictures until the next key picture. A viewer that has the stream's
  // base picture needs no JPEG picture.
  if (watch.place.BaseOf(*video_tier) != 0 || !is_new) return std::nullopt;
  return Offer{
      described.sequence,
      {FrameForm::Kind::kJpeg, std::max(for_window, std::min(watch.link.step(), kTiers - 1))},
      {}};
}

std::optional<FrameHub::Offer> FrameHub::NextFor(const Watch& watch, Time now) const {
  if (frame_ == nullptr || !IsReady(watch, now)) return std::nullopt;
  return OfferFor(watch, *frame_, now);
}

bool FrameHub::HasFor(const Watch& watch, Time now) const {
  return NextFor(watch, now).has_value() ||
         (problem_.has_value() && problem_count_ > watch.last_problem);
}

std::optional<FrameEvent> FrameHub::Take(std::uint64_t viewer_id, std::optional<Time> at) {
  const Time now = at.value_or(time_.Now());
  std::shared_ptr<PublishedFrame> published;
  std::optional<Offer> offer;
  bool waits = false;
  {
    const std::lock_guard lock(mutex_);
    const auto found = watches_.find(viewer_id);
    if (found == watches_.end() || !closed_because_.ok()) return std::nullopt;
    Watch& watch = found->second;
    offer = NextFor(watch, now);
    if (offer.has_value()) {
      published = frame_;
      waits = Took(watch, *offer, now);
    } else if (problem_.has_value() && problem_count_ > watch.last_problem) {
      watch.last_problem = problem_count_;
      return *problem_;
    } else {
      return std::nullopt;
    }
  }
  if (waits) on_wait_();
  const std::shared_ptr<const EncodedFrame> frame = Made(*offer, *published);
  if (frame == nullptr) return NotMade(viewer_id, *offer);
  Counted().frames_sent.Add();
  Counted().frame_bytes_sent.Add(frame->jpeg.size() + frame->vp9.size() + frame->avif.size());
  return frame;
}

std::optional<FrameEvent> FrameHub::NotMade(std::uint64_t viewer_id, const Offer& offer) {
  std::optional<FrameEvent> event;
  {
    const std::lock_guard lock(mutex_);
    const auto found = watches_.find(viewer_id);
    if (found == watches_.end()) return std::nullopt;
    Watch& watch = found->second;
    const auto sent =
        std::find_if(watch.in_flight.rbegin(), watch.in_flight.rend(),
                     [&](const Sent& each) { return each.sequence == offer.sequence; });
    if (sent != watch.in_flight.rend()) watch.in_flight.erase(std::next(sent).base());
    if (problem_.has_value() && problem_count_ > watch.last_problem) {
      watch.last_problem = problem_count_;
      event = *problem_;
    }
  }
  on_demand_();
  return event;
}

// Runs without the lock, because a JPEG tier that no viewer has needed so far is encoded here.
std::shared_ptr<const EncodedFrame> FrameHub::Made(const Offer& offer, PublishedFrame& published) {
  switch (offer.form.kind) {
    case FrameForm::Kind::kVideo:
      return offer.picture.frame;
    case FrameForm::Kind::kResting:
      return published.RestingFrame(offer.form.tier);
    case FrameForm::Kind::kJpeg:
      break;
  }
  return published.Jpeg(offer.form.tier);
}

bool FrameHub::Took(Watch& watch, const Offer& offer, Time now) {
  const bool is_video = offer.form.kind == FrameForm::Kind::kVideo;
  if (is_video) {
    watch.place.Enter(offer.form.tier);
    watch.place.Took(offer.sequence, offer.picture, now);
  }
  const EncodedFrame& frame = is_video ? *offer.picture.frame : frame_->Described();
  if (!VideoTier(watch, WidthOf(frame_->Described())).has_value()) watch.place.Leave();
  // Only a viewer that has received a frame can miss one. A better form of the same frame is not
  // another frame.
  const bool has_had_any = watch.last_sequence > 0;
  if (has_had_any && offer.sequence > watch.last_sequence) {
    Counted().frames_skipped.Add(offer.sequence - watch.last_sequence - 1);
  }
  const bool first_of_revision = has_had_any && frame.scene_revision > watch.last_revision;
  watch.last_form = offer.form;
  watch.last_sequence = offer.sequence;
  watch.last_revision = frame.scene_revision;
  const bool moving = is_video || (!frame_->Rests() && offer.form.kind == FrameForm::Kind::kJpeg);
  const bool is_last = watch.in_flight.size() + 1 >= MaxInFlight(watch);
  watch.in_flight.push_back({offer.sequence, now, moving, is_video, is_last,
                             first_of_revision ? frame.changed_at : std::nullopt});
  if (watch.wants.frames_per_second <= 0.0) return false;
  constexpr double kFewest_per_s = 0.1;
  const std::chrono::duration<double> pause(1.0 /
                                            std::max(watch.wants.frames_per_second, kFewest_per_s));
  watch.waits_until = now + std::chrono::duration_cast<Time::duration>(pause);
  return true;
}

bool FrameHub::Acknowledge(std::uint64_t viewer_id, std::uint64_t sequence,
                           std::optional<Time> at) {
  const Time now = at.value_or(time_.Now());
  std::shared_ptr<Viewer> viewer;
  bool became_ready = false;
  {
    const std::lock_guard lock(mutex_);
    const auto found = watches_.find(viewer_id);
    if (found == watches_.end()) return false;
    Watch& watch = found->second;
    auto& in_flight = watch.in_flight;
    const bool was_full = in_flight.size() >= MaxInFlight(watch);
    while (!in_flight.empty() && in_flight.front().sequence <= sequence) {
      const Sent& sent = in_flight.front();
      if (sent.changed_at.has_value()) {
        const std::chrono::duration<double> took = now - *sent.changed_at;
        Counted().update_to_frame.Observe(took.count());
      }
      if (sent.moving) watch.link.Acknowledged(now, sent.at);
      if (sent.video) watch.window.Acknowledged(now - sent.at, sent.was_last);
      in_flight.pop_front();
    }
    became_ready = was_full && in_flight.size() < MaxInFlight(watch);
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

void FrameHub::LoseVideo(std::uint64_t viewer_id, std::optional<Time> at) {
  const Time now = at.value_or(time_.Now());
  const std::lock_guard lock(mutex_);
  const auto found = watches_.find(viewer_id);
  if (found != watches_.end()) found->second.place.Lost(now);
}

std::vector<VideoOrder> FrameHub::OrderVideo(const EncodedFrame& described,
                                             bool resting_frame_follows, std::optional<Time> at) {
  const Time now = at.value_or(time_.Now());
  const std::lock_guard lock(mutex_);
  for (VideoStream& stream : streams_) stream.Begin();
  for (auto& [id, watch] : watches_) {
    const std::optional<int> tier = VideoTier(watch, WidthOf(described));
    const bool gets_jpeg =
        described.at_rest && !(resting_frame_follows && watch.wants.takes_resting_frames);
    const bool waits = resting_frame_follows && KeepsRestingFrame(watch, described, now);
    if (!tier.has_value() || gets_jpeg || waits) continue;
    streams_[static_cast<std::size_t>(*tier)].Ask(
        *tier, {&watch.place, IsReady(watch, now), watch.last_sequence}, now);
  }
  std::vector<VideoOrder> orders;
  for (int tier = 0; tier < kTiers; ++tier) {
    const auto kind = streams_[static_cast<std::size_t>(tier)].Next(now);
    if (kind.has_value()) orders.push_back({tier, *kind});
  }
  return orders;
}

std::uint64_t FrameHub::Publish(EncodedFrame described, EncodeFrame encode,
                                std::vector<EncodedVideo> video, bool resting_frame_follows,
                                std::optional<Time> at) {
  const Time now = at.value_or(time_.Now());
  const std::uint64_t scene_revision = described.scene_revision;
  std::shared_ptr<PublishedFrame> published;
  std::array<bool, kTiers> wanted{};
  std::uint64_t sequence = 0;
  {
    const std::lock_guard lock(mutex_);
    sequence = ++frame_count_;
    described.sequence = sequence;
    const bool goes_on = resting_frame_follows && frame_ != nullptr &&
                         frame_->Described().scene_revision == scene_revision;
    if (!goes_on) resting_frame_due_since_.reset();
    if (resting_frame_follows && !resting_frame_due_since_.has_value())
      resting_frame_due_since_ = now;
    VideoPictures pictures;
    for (EncodedVideo& one : video) {
      one.frame.sequence = sequence;
      const auto tier = static_cast<std::size_t>(one.order.tier);
      pictures[tier] =
          streams_[tier].Add(sequence, one.order.kind,
                             std::make_shared<const EncodedFrame>(std::move(one.frame)), now);
    }
    published = std::make_shared<PublishedFrame>(std::move(described), std::move(encode),
                                                 std::move(pictures), resting_frame_follows);
    for (const auto& [id, watch] : watches_) {
      const auto offer = OfferFor(watch, *published, now);
      if (offer.has_value() && offer->form.kind == FrameForm::Kind::kJpeg) {
        wanted[static_cast<std::size_t>(offer->form.tier)] = true;
      }
    }
  }
  for (int tier = 0; tier < kTiers; ++tier) {
    if (wanted[static_cast<std::size_t>(tier)]) (void)published->Jpeg(tier);
  }
  {
    const std::lock_guard lock(mutex_);
    if (problem_.has_value() && problem_->scene_revision <= scene_revision) problem_.reset();
    frame_ = published;
  }
  WakeAll();
  return sequence;
}

std::shared_ptr<PublishedFrame> FrameHub::Newest(std::uint64_t sequence) const {
  const std::lock_guard lock(mutex_);
  const bool is_newest = frame_ != nullptr && frame_->Described().sequence == sequence;
  return is_newest ? frame_ : nullptr;
}

bool FrameHub::IsNewest(std::uint64_t sequence) const { return Newest(sequence) != nullptr; }

void FrameHub::AddRestingFrame(std::uint64_t sequence, int tier, EncodedFrame resting_frame) {
  const auto frame = Newest(sequence);
  if (frame == nullptr) return;
  resting_frame.sequence = sequence;
  frame->SetRestingFrame(tier, std::move(resting_frame));
  RestingFrameCame();
  frame->Rest();
  WakeAll();
}

void FrameHub::NoRestingFrame(std::uint64_t sequence) {
  const auto frame = Newest(sequence);
  if (frame == nullptr) return;
  frame->NoRestingFrame();
  RestingFrameCame();
  WakeAll();
}

void FrameHub::RestingFrameCame() {
  const std::lock_guard lock(mutex_);
  resting_frame_due_since_.reset();
}

void FrameHub::Rest(std::uint64_t sequence) {
  const auto frame = Newest(sequence);
  if (frame == nullptr || frame->Rests()) return;
  frame->Rest();
  WakeAll();
}

void FrameHub::Publish(Problem problem) {
  Note(std::move(problem));
  WakeAll();
}

bool FrameHub::DropUnwatched() {
  std::shared_ptr<PublishedFrame> dropped;
  const std::lock_guard lock(mutex_);
  if (watches_.empty()) dropped = std::exchange(frame_, nullptr);
  return dropped != nullptr;
}

void FrameHub::Note(Problem problem) {
  const std::lock_guard lock(mutex_);
  ++problem_count_;
  problem_ = std::move(problem);
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

std::size_t FrameHub::Viewers() const {
  const std::lock_guard lock(mutex_);
  return watches_.size();
}

bool FrameHub::HasViewers() const {
  const std::lock_guard lock(mutex_);
  return !watches_.empty();
}

std::array<bool, kTiers> FrameHub::RestingTiers(const PictureWidth& width) const {
  std::array<bool, kTiers> wanted{};
  const std::lock_guard lock(mutex_);
  for (const auto& [id, watch] : watches_) {
    if (!watch.wants.takes_resting_frames) continue;
    wanted[static_cast<std::size_t>(TierForWindow(width, watch.wants.window_width_px))] = true;
  }
  return wanted;
}

bool FrameHub::HasReadyViewer() const {
  const Time now = time_.Now();
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

}  // namespace thunderhead::delivery
