#include "drawing/still_maker.h"

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

StillMaker::StillMaker(SerializeFrame serialize, const base::TimeSource& time)
    : serialize_(std::move(serialize)), time_(time), thread_([this] { Run(); }) {}

StillMaker::~StillMaker() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void StillMaker::Make(StillToMake still) {
  const auto session = still.session.lock();
  if (session == nullptr) return;
  const Time now = time_.Now();
  Time due = still.described.at_rest ? now : std::max(now + kRestsAfter, still.rests_at);
  {
    const std::lock_guard lock(mutex_);
    // An improved picture at rest keeps the due time of the one that it replaces.
    const auto before = waiting_.find(session.get());
    if (still.described.at_rest && before != waiting_.end()) {
      due = std::min(due, before->second.due);
    }
    waiting_[session.get()] = {std::move(still), due};
  }
  changed_.notify_all();
}

void StillMaker::Run() {
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
      const StillToMake still = std::move(next->second.still);
      waiting_.erase(next);
      lock.unlock();
      MakeNow(still);
      lock.lock();
    }
  }
}

absl::StatusOr<delivery::EncodedFrame> StillMaker::Encoded(const StillToMake& still,
                                                           int tier) const {
  const base::Stopwatch stopwatch;
  const frame::FineImage& image = still.fine->At(tier);
  delivery::EncodedFrame frame = still.described;
  THUNDERHEAD_ASSIGN_OR_RETURN(frame.avif, codec::EncodeAvif(image));
  frame.width_px = image.width_px;
  frame.height_px = image.height_px;
  frame.tier = tier;
  frame.stages.push_back({scene::FrameStage::kEncode, stopwatch.ElapsedMs()});
  frame.serialized = serialize_(frame);
  return frame;
}

void StillMaker::MakeNow(const StillToMake& still) const {
  const auto session = still.session.lock();
  if (session == nullptr || !session->hub().IsNewest(still.sequence)) return;
  session->hub().Rest(still.sequence);
  if (still.fine == nullptr) return;
  const std::array<bool, delivery::kTiers> wanted =
      session->hub().StillTiers(delivery::WidthOf(still.described));
  for (int tier = 0; tier < delivery::kTiers; ++tier) {
    if (!wanted[static_cast<std::size_t>(tier)]) continue;
    if (!session->hub().IsNewest(still.sequence)) return;
    auto frame = base::Guarded([&] { return Encoded(still, tier); });
    if (!frame.ok()) {
      base::LogError(base::Annotate(frame.status(), "making a still of higher quality"));
      return session->hub().NoStills(still.sequence);
    }
    session->hub().AddStill(still.sequence, tier, *std::move(frame));
  }
  // Viewers that now need a tier for which no still was made get no still of this frame.
  session->hub().NoStills(still.sequence);
}

}  // namespace thunderhead::drawing
