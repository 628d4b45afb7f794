#include "session/turns.h"

#include <algorithm>
#include <limits>
#include <set>

namespace thunderhead::session {
namespace {

// A class that is owed less than half a piece waits.
constexpr double kWorthATurn_ms = 7.5;

std::size_t IndexOf(TurnClass turn_class) { return static_cast<std::size_t>(turn_class); }

// What people see together and what one sees for himself, in each class.
std::string GroupOf(const Contender& contender) {
  return std::to_string(IndexOf(*contender.work)) + (contender.own_view ? " own" : "");
}

// Raises all balances by as much as lets one of `waiting` have a turn.
void Refill(const std::set<std::string>& waiting, std::map<std::string, double>* balances) {
  double best = -std::numeric_limits<double>::infinity();
  for (const std::string& id : waiting) best = std::max(best, (*balances)[id]);
  for (auto& [id, balance] : *balances) balance = std::min(balance - best, 0.0);
}

}  // namespace

std::optional<TurnClass> Turns::ClassNow(const std::vector<Contender>& contenders) {
  waits_.fill(false);
  for (const Contender& contender : contenders) {
    if (contender.work.has_value()) waits_[IndexOf(*contender.work)] = true;
  }
  for (std::size_t i = 0; i < kTurnClasses; ++i) {
    if (!waits_[i]) owed_ms_[i] = 0.0;
  }
  for (std::size_t i = kTurnClasses; i-- > 1;) {
    if (owed_ms_[i] >= kWorthATurn_ms) return static_cast<TurnClass>(i);
  }
  const auto first = std::find(waits_.begin(), waits_.end(), true);
  if (first == waits_.end()) return std::nullopt;
  return static_cast<TurnClass>(first - waits_.begin());
}

std::optional<std::size_t> Turns::Next(const std::vector<Contender>& contenders) {
  std::set<std::string> present;
  for (const Contender& contender : contenders) present.insert(contender.id);
  std::erase_if(balances_, [&](const auto& entry) { return !present.contains(entry.first); });
  const std::optional<TurnClass> now = ClassNow(contenders);
  if (!now.has_value()) return std::nullopt;

  std::set<std::string> groups;
  for (const Contender& contender : contenders) {
    if (contender.work == now) groups.insert(GroupOf(contender));
  }
  Refill(groups, &group_balances_);
  std::set<std::string> waiting;
  for (const Contender& contender : contenders) {
    if (contender.work == now && group_balances_[GroupOf(contender)] == 0.0) {
      waiting.insert(contender.id);
    }
  }
  Refill(waiting, &balances_);
  std::optional<std::size_t> next;
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    const std::string& id = contenders[i].id;
    if (!waiting.contains(id) || balances_[id] < 0.0) continue;
    if (id > last_served_) return i;
    if (!next.has_value()) next = i;
  }
  return next;
}

void Turns::Used(const Contender& contender, double milliseconds) {
  balances_[contender.id] -= milliseconds;
  group_balances_[GroupOf(contender)] -= milliseconds;
  last_served_ = contender.id;
  const std::size_t used = IndexOf(*contender.work);
  owed_ms_[used] = std::max(owed_ms_[used] - milliseconds, 0.0);
  for (std::size_t i = used + 1; i < kTurnClasses; ++i) {
    if (waits_[i]) owed_ms_[i] += milliseconds * kLeastShare / (1.0 - kLeastShare);
  }
}

}  // namespace thunderhead::session
