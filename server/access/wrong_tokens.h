// Holds back who tries tokens: a network that has shown many wrong ones may show no other for a
// while, but those that were right, which others behind the same address have. Safe from any
// thread.
#pragma once

#include <chrono>
#include <mutex>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "access/identity.h"
#include "base/allowance.h"

namespace thunderhead::access {

class WrongTokens {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // Of one network; twice as many at once after a second of rest. 0: no limit.
  explicit WrongTokens(double per_second) : left_(per_second) {}

  // RESOURCE_EXHAUSTED with the time after which to try again if the token is not to be looked at.
  absl::Status MayShow(const Credentials& shown, Time now);
  void WasRight(const Credentials& shown);
  // A call without a token tries none.
  void WasWrong(const Credentials& shown, Time now);

 private:
  bool Counts(const Credentials& shown) const {
    return left_.PerSecond() > 0.0 && !shown.token.empty();
  }

  std::mutex mutex_;
  base::Allowances left_;        // by network
  std::set<std::string> right_;  // their digests, not the tokens
};

}  // namespace thunderhead::access
