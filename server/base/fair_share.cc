#include "base/fair_share.h"

#include <algorithm>
#include <limits>

namespace thunderhead::base {

std::string FairShare::Next(const std::vector<std::string>& waiting) {
  return *Next(waiting, [](const std::string&) { return true; });
}

std::optional<std::string> FairShare::Next(const std::vector<std::string>& waiting,
                                           const std::function<bool(const std::string&)>& may) {
  Account newcomer{std::numeric_limits<double>::infinity(), 0.0};
  for (const std::string& id : waiting) {
    const auto known = accounts_.find(id);
    if (known == accounts_.end()) continue;
    newcomer.settled_ms = std::min(newcomer.settled_ms, known->second.settled_ms);
  }
  if (newcomer.settled_ms == std::numeric_limits<double>::infinity()) newcomer.settled_ms = 0.0;
  std::map<std::string, Account> accounts;
  std::optional<std::string> next;
  double next_ms = std::numeric_limits<double>::infinity();
  for (const std::string& id : waiting) {
    const auto known = accounts_.find(id);
    const Account account = known != accounts_.end() ? known->second : newcomer;
    accounts[id] = account;
    const double used_ms = account.settled_ms + account.charged_ms;
    if (used_ms >= next_ms || !may(id)) continue;
    next = id;
    next_ms = used_ms;
  }
  accounts_ = std::move(accounts);
  return next;
}

void FairShare::Charge(const std::string& id, double expected_ms) {
  const auto known = accounts_.find(id);
  if (known != accounts_.end()) known->second.charged_ms += expected_ms;
}

void FairShare::Settle(const std::string& id, double charged_ms, double used_ms) {
  const auto known = accounts_.find(id);
  if (known == accounts_.end()) return;
  // The charge may be missing: a client that was forgotten after the charge has a new account
  // without the charge. The result is therefore limited to 0.
  known->second.charged_ms = std::max(0.0, known->second.charged_ms - charged_ms);
  known->second.settled_ms += used_ms;
}

}  // namespace thunderhead::base
