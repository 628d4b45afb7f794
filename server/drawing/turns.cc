#include "drawing/turns.h"

#include <algorithm>
#include <limits>
#include <set>

namespace thunderhead::drawing {
namespace {

// A class gets a turn before the earlier classes only if it is owed at least this much time, about
// half a piece.
constexpr double kWorthATurn_ms = 7.5;

std::size_t IndexOf(TurnClass turn_class) { return static_cast<std::size_t>(turn_class); }

// Shared and own views form separate groups in each class.
std::string GroupOf(const Contender& contender) {
  return std::to_string(IndexOf(*contender.work)) + (contender.own_view ? " own" : "");
}

struct Refilled {
  std::string next;
  double raised_ms = 0.0;
};

// Raises all balances until one id in `waiting` has a balance of zero, and returns that id. Among
// several such ids, it is the next one after `last`.
Refilled Refill(const std::set<std::string>& waiting, const std::string& last,
                std::map<std::string, double>* balances) {
  double best = -std::numeric_limits<double>::infinity();
  for (const std::string& id : waiting) best = std::max(best, (*balances)[id]);
  for (auto& [id, balance] : *balances) balance = std::min(balance - best, 0.0);
  std::string next;
  for (const std::string& id : waiting) {
    if ((*balances)[id] < 0.0) continue;
    if (id > last) return {id, -best};
    if (next.empty()) next = id;
  }
  return {next, -best};
}

}  // namespace

void Turns::Leave(const std::set<std::string>& present, Group* group) {
  std::erase_if(group->balances, [&](const auto& entry) {
    if (present.contains(entry.first)) return false;
    if (entry.second < 0.0) group->left_behind.push_back(entry.second);
    return true;
  });
}

std::string Turns::NextOf(const std::set<std::string>& waiting, Group* group) {
  for (const std::string& id : waiting) {
    if (group->left_behind.empty()) break;
    if (group->balances.contains(id)) continue;
    const auto deepest = std::ranges::min_element(group->left_behind);
    group->balances[id] = *deepest;
    group->left_behind.erase(deepest);
  }
  const Refilled refilled = Refill(waiting, group->last_served, &group->balances);
  for (double& balance : group->left_behind) balance += refilled.raised_ms;
  std::erase_if(group->left_behind, [](double balance) { return balance >= 0.0; });
  return refilled.next;
}

std::optional<TurnClass> Turns::ClassNow(const std::vector<Contender>& contenders) {
  std::array<bool, kTurnClasses> waits{};
  for (const Contender& contender : contenders) {
    if (contender.work.has_value()) waits[IndexOf(*contender.work)] = true;
  }
  for (std::size_t i = 0; i < kTurnClasses; ++i) {
    if (!waits[i]) owed_ms_[i] = std::min(owed_ms_[i], 0.0);
  }
  for (std::size_t i = kTurnClasses; i-- > 1;) {
    if (owed_ms_[i] >= kWorthATurn_ms) return static_cast<TurnClass>(i);
  }
  const auto first = std::find(waits.begin(), waits.end(), true);
  if (first == waits.end()) return std::nullopt;
  return static_cast<TurnClass>(first - waits.begin());
}

std::optional<std::size_t> Turns::Next(const std::vector<Contender>& contenders) {
  std::set<std::string> present;
  for (const Contender& contender : contenders) present.insert(contender.id);
  for (auto& [name, group] : groups_) Leave(present, &group);
  const std::optional<TurnClass> now = ClassNow(contenders);
  if (!now.has_value()) return std::nullopt;

  std::map<std::string, std::set<std::string>> waiting;  // by group
  std::set<std::string> groups;
  for (const Contender& contender : contenders) {
    if (contender.work != now) continue;
    waiting[GroupOf(contender)].insert(contender.id);
    groups.insert(GroupOf(contender));
  }
  const std::string name = Refill(groups, last_group_, &group_balances_).next;
  const std::string id = NextOf(waiting[name], &groups_[name]);
  const auto next = std::ranges::find(contenders, id, &Contender::id);
  return static_cast<std::size_t>(next - contenders.begin());
}

void Turns::Used(const Contender& contender, double milliseconds) {
  last_group_ = GroupOf(contender);
  group_balances_[last_group_] -= milliseconds;
  Group& group = groups_[last_group_];
  group.balances[contender.id] -= milliseconds;
  group.last_served = contender.id;
  const std::size_t used = IndexOf(*contender.work);
  // If no other class had work, this class owes the others at most its last turn.
  owed_ms_[used] = std::max(owed_ms_[used] - milliseconds, -milliseconds);
  for (std::size_t i = used + 1; i < kTurnClasses; ++i) {
    owed_ms_[i] += milliseconds * kMinShare / (1.0 - kMinShare);
  }
}

}  // namespace thunderhead::drawing
