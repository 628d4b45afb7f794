#include "drawing/resting_frame_encoder.h"

#include <algorithm>
#include <utility>

#include "base/guarded.h"
#include "base/log.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "base/thread_priority.h"
#include "codec/avif.h"

namespace thunderhead::drawing {
namespace {

constexpr int kNiceness = 10;

}  // namespace

RestingFrameEncoder::RestingFrameEncoder(SerializeFrame serialize, const base::TimeSource& time)
    : serialize_(std::move(serialize)), time_(time), thread_([this] { Run(); }) {}

RestingFrameEncoder::~RestingFrameEncoder() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void RestingFrameEncoder::Encode(RestingFrame resting) {
  const auto session = resting.session.lock();
  if (session == nullptr) return;
  const Time now = time_.Now();
  Time due = resting.described.at_rest ? now : std::max(now + kRestsAfter, resting.rests_at);
  {
    const std::lock_guard lock(mutex_);
    // An improved picture at rest keeps the due time of the one that it replaces.
    const auto before = waiting_.find(session.get());
    if (resting.described.at_rest && before != waiting_.end()) {
      due = std::min(due, before->second.due);
    }
    waiting_[session.get()] = {std::move(resting), due};
  }
  changed_.notify_all();
}

void RestingFrameEncoder::Run() {
  base::LowerPriority(kNiceness);
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    const auto next =
        std::min_element(waiting_.begin(), waiting_.end(),
                         [](const auto& a, const auto& b) { return a.second.due < b.second.due; });
    if (next == waiting_.end()) {
      changed_.wait(lock);
    } else if (const Time due = next->second.due; time_.Now() < due) {
      changed_.wait_until(lock, time_.LookAgainAt(due));
    } else {
      const RestingFrame resting = std::move(next->second.resting);
      waiting_.erase(next);
      lock.unlock();
      EncodeNow(resting);
      lock.lock();
    }
  }
}

absl::StatusOr<delivery::EncodedFrame> RestingFrameEncoder::Encoded(const RestingFrame& resting,
                                                                    int tier) const {
  const base::Stopwatch stopwatch;
  const frame::FineImage& image = resting.fine->At(tier);
  delivery::EncodedFrame frame = resting.described;
  THUNDERHEAD_ASSIGN_OR_RETURN(frame.avif, codec::EncodeAvif(image));
  frame.width_px = image.width_px;
  frame.height_px = image.height_px;
  frame.tier = tier;
  frame.stages.push_back({scene::FrameStage::kEncode, stopwatch.ElapsedMs()});
  frame.serialized = serialize_(frame);
  return frame;
}

void RestingFrameEncoder::EncodeNow(const RestingFrame& resting) const {
  const auto session = resting.session.lock();
  if (session == nullptr || !session->hub().IsNewest(resting.sequence)) return;
  session->hub().Rest(resting.sequence);
  if (resting.fine == nullptr) return;
  const std::array<bool, delivery::kTiers> wanted =
      session->hub().RestingTiers(delivery::WidthOf(resting.described));
  for (int tier = 0; tier < delivery::kTiers; ++tier) {
    if (!wanted[static_cast<std::size_t>(tier)]) continue;
    if (!session->hub().IsNewest(resting.sequence)) return;
    auto frame = base::Guarded([&] { return Encoded(resting, tier); });
    if (!frame.ok()) {
      base::LogError(base::Annotate(frame.status(), "encoding a resting frame"));
      return session->hub().NoRestingFrame(resting.sequence);
    }
    session->hub().AddRestingFrame(resting.sequence, tier, *std::move(frame));
  }
  // Viewers that now need a tier that was not encoded get no resting frame.
  session->hub().NoRestingFrame(resting.sequence);
}

}  // namespace thunderhead::drawing
