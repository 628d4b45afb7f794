#include "session/turns.h"

#include <algorithm>

namespace thunderhead::session {
namespace {

std::optional<Clock::time_point> Earlier(const std::optional<Clock::time_point>& a,
                                         const std::optional<Clock::time_point>& b) {
  if (!a.has_value()) return b;
  if (!b.has_value()) return a;
  return std::min(*a, *b);
}

}  // namespace

std::optional<Clock::time_point> Turns::Next(const std::vector<std::string>& ids,
                                             const TakeTurn& take_turn) {
  const auto after_last = std::upper_bound(ids.begin(), ids.end(), last_served_);
  const auto first = static_cast<std::size_t>(after_last - ids.begin());
  std::optional<Clock::time_point> look_again_at;
  std::vector<std::size_t> with_background_work;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const std::size_t index = (first + i) % ids.size();
    const TurnOutcome outcome = take_turn(index, TurnKind::kAny);
    if (outcome.drew) {
      last_served_ = ids[index];
      last_drew_at_ = Clock::now();
      return last_drew_at_;
    }
    if (outcome.has_background_work) with_background_work.push_back(index);
    look_again_at = Earlier(look_again_at, outcome.look_again_at);
  }
  if (with_background_work.empty()) return look_again_at;
  if (last_drew_at_.has_value() && Clock::now() < *last_drew_at_ + kQuietBeforeBackground) {
    return Earlier(look_again_at, *last_drew_at_ + kQuietBeforeBackground);
  }
  for (const std::size_t index : with_background_work) {
    const TurnOutcome outcome = take_turn(index, TurnKind::kBackground);
    if (outcome.drew) {
      last_served_ = ids[index];
      return Clock::now();
    }
    look_again_at = Earlier(look_again_at, outcome.look_again_at);
  }
  return look_again_at;
}

}  // namespace thunderhead::session
