#include "desktop/history.h"

#include <google/protobuf/util/message_differencer.h>

#include <algorithm>
#include <utility>

#include "desktop/scene_change.h"

namespace thunderhead::desktop {
namespace {

using google::protobuf::util::MessageDifferencer;

constexpr std::chrono::milliseconds kMoment{700};
constexpr std::size_t kMaxSteps = 100;

}  // namespace

void History::Record(const v1::Scene& before, const v1::Scene& after, const std::string& subject,
                     TimePoint now) {
  const bool goes_on = subject == subject_ && IsOpen(now);
  subject_ = subject;
  last_ = now;
  undone_.clear();
  if (!goes_on) {
    done_.push_back({{before, after}});
    if (done_.size() > kMaxSteps) done_.erase(done_.begin());
    return;
  }
  Step& step = done_.back();
  if (MessageDifferencer::Equals(step.back().after, before)) {
    step.back().after = after;
  } else {
    step.push_back({before, after});
  }
}

bool History::IsOpen(TimePoint now) const {
  return !subject_.empty() && now - last_ < kMoment && !done_.empty();
}

std::optional<History::Edit> History::Undo() {
  subject_.clear();
  if (done_.empty()) return {};
  undone_.push_back(std::move(done_.back()));
  done_.pop_back();
  return [step = undone_.back()](v1::Scene& scene) {
    std::for_each(step.rbegin(), step.rend(),
                  [&](const Change& change) { MakeChange(change.after, change.before, scene); });
  };
}

std::optional<History::Edit> History::Redo() {
  subject_.clear();
  if (undone_.empty()) return {};
  done_.push_back(std::move(undone_.back()));
  undone_.pop_back();
  return [step = done_.back()](v1::Scene& scene) {
    for (const Change& change : step) MakeChange(change.before, change.after, scene);
  };
}

void History::Clear() {
  done_.clear();
  undone_.clear();
  subject_.clear();
}

}  // namespace thunderhead::desktop
