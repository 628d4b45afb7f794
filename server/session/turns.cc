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

std::optional<Clock::time_point> Turns::Next(
    const std::vector<std::string>& ids, const std::function<TurnOutcome(std::size_t)>& take_turn) {
  const auto after_last = std::upper_bound(ids.begin(), ids.end(), last_served_);
  const auto first = static_cast<std::size_t>(after_last - ids.begin());
  std::optional<Clock::time_point> look_again_at;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const std::size_t index = (first + i) % ids.size();
    const TurnOutcome outcome = take_turn(index);
    if (outcome.drew) {
      last_served_ = ids[index];
      return Clock::now();
    }
    look_again_at = Earlier(look_again_at, outcome.look_again_at);
  }
  return look_again_at;
}

}  // namespace thunderhead::session
