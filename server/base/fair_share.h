// A fair scheduler: it chooses the client that has used the least processing time so far. It is a
// plain value type.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace thunderhead::base {

class FairShare {
 public:
  // Returns the client of `waiting` that has used the least time, or the first of several with
  // equal times. Time that was charged in advance counts as used. `waiting` must not be empty.
  //
  // A client that is new, or that returns after a pause, starts with the least settled time of the
  // waiting clients that are already known. Their charges do not count for it, because a charge may
  // turn out to be too high.
  std::string Next(const std::vector<std::string>& waiting);
  // Considers only the clients for which `may` returns true. Returns nothing if there is no such
  // client.
  std::optional<std::string> Next(const std::vector<std::string>& waiting,
                                  const std::function<bool(const std::string&)>& may);

  // Charges the client in advance for the expected time of a task that starts now.
  void Charge(const std::string& id, double expected_ms);
  // Replaces the charge of a task that has ended by the time that it used, which is 0 for a task
  // that was dropped. Each charge must be settled once.
  void Settle(const std::string& id, double charged_ms, double used_ms);

 private:
  struct Account {
    double settled_ms = 0.0;  // time used by tasks that have ended
    double charged_ms = 0.0;  // expected time of tasks that have not ended
  };
  // Accounts of the clients that were waiting at the last call of Next.
  std::map<std::string, Account> accounts_;
};

}  // namespace thunderhead::base
