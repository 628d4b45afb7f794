// Limits attempts to guess tokens. A network that has presented many wrong tokens may present no
// new ones for a while. It may still present tokens that were valid before, because other clients
// may share its address. Safe from any thread.
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

  // `per_second` is the maximum mean rate of wrong tokens from one network. After a pause, the
  // wrong tokens of two seconds are allowed at once. 0 means no limit.
  explicit WrongTokens(double per_second) : left_(per_second) {}

  // Returns RESOURCE_EXHAUSTED with a retry delay if the token must not be checked.
  absl::Status MayShow(const Credentials& shown, Time now);
  void WasRight(const Credentials& shown);
  // Records a wrong token. A call without a token does not count.
  void WasWrong(const Credentials& shown, Time now);

 private:
  bool Counts(const Credentials& shown) const {
    return left_.PerSecond() > 0.0 && !shown.token.empty();
  }

  std::mutex mutex_;
  base::Allowances left_;        // token buckets by network
  std::set<std::string> right_;  // digests of tokens that were valid, instead of the tokens
};

}  // namespace thunderhead::access
