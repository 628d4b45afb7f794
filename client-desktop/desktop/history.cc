#include "desktop/history.h"

namespace thunderhead::desktop {
namespace {

constexpr std::chrono::milliseconds kMoment{700};
constexpr std::size_t kMost = 100;

std::optional<v1::Scene> Go(const v1::Scene& now, std::vector<v1::Scene>& from,
                            std::vector<v1::Scene>& to) {
  if (from.empty()) return {};
  v1::Scene scene = std::move(from.back());
  from.pop_back();
  to.push_back(now);
  return scene;
}

}  // namespace

void History::Record(const v1::Scene& before, const std::string& subject, TimePoint now) {
  const bool goes_on = subject == subject_ && now - last_ < kMoment && !done_.empty();
  subject_ = subject;
  last_ = now;
  if (goes_on) return;
  undone_.clear();
  done_.push_back(before);
  if (done_.size() > kMost) done_.erase(done_.begin());
}

std::optional<v1::Scene> History::Undo(const v1::Scene& now) {
  subject_.clear();
  return Go(now, done_, undone_);
}

std::optional<v1::Scene> History::Redo(const v1::Scene& now) {
  subject_.clear();
  return Go(now, undone_, done_);
}

}  // namespace thunderhead::desktop
