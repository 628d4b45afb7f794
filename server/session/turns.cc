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

std::vector<std::size_t> Turns::Order(const std::vector<Contender>& contenders) const {
  std::vector<std::size_t> order;
  const auto add = [&](bool own_view, const std::string& last_served) {
    const auto begin = static_cast<std::ptrdiff_t>(order.size());
    std::ptrdiff_t until_last = 0;
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      if (contenders[i].own_view != own_view) continue;
      if (contenders[i].id <= last_served) ++until_last;
      order.push_back(i);
    }
    std::rotate(order.begin() + begin, order.begin() + begin + until_last, order.end());
  };
  add(own_views_first_, own_views_first_ ? last_own_view_served_ : last_served_);
  add(!own_views_first_, own_views_first_ ? last_served_ : last_own_view_served_);
  return order;
}

void Turns::Served(const Contender& contender) {
  (contender.own_view ? last_own_view_served_ : last_served_) = contender.id;
  own_views_first_ = !contender.own_view;
}

std::optional<Clock::time_point> Turns::Next(const std::vector<Contender>& contenders,
                                             const TakeTurn& take_turn) {
  std::optional<Clock::time_point> look_again_at;
  std::vector<std::size_t> with_background_work;
  for (const std::size_t index : Order(contenders)) {
    const TurnOutcome outcome = take_turn(index, TurnKind::kAny);
    if (outcome.drew) {
      Served(contenders[index]);
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
      Served(contenders[index]);
      return Clock::now();
    }
    look_again_at = Earlier(look_again_at, outcome.look_again_at);
  }
  return look_again_at;
}

}  // namespace thunderhead::session
