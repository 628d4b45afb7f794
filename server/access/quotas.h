// How much one identity may ask for, and all together: calls that stay open, and requests a second.
// Each refusal is RESOURCE_EXHAUSTED with the time after which to try again. Safe from any thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/allowance.h"

namespace thunderhead::access {

struct QuotaLimits {
  std::size_t max_streams = 2048;
  std::size_t max_streams_per_identity = 512;
  // The mean; twice as many at once after a second of rest. 0: no limit.
  double requests_per_second = 500.0;
  // Of invalid tokens from one network: beyond this limit it may only show tokens that were valid
  // before.
  double wrong_tokens_per_second = 5.0;
};

// Requests that are allowed now: they come back with time.
class RequestBudget {
 public:
  using Time = base::Allowance::Time;

  // `per_second` 0: no limit.
  RequestBudget(double per_second, Time now) : per_second_(per_second), left_(per_second, now) {}

  // RESOURCE_EXHAUSTED if there is none left.
  absl::Status Take(Time now);

 private:
  const double per_second_;
  base::Allowance left_;
};

class Quotas {
 public:
  using Time = RequestBudget::Time;

  explicit Quotas(const QuotaLimits& limits)
      : limits_(limits), requests_(limits.requests_per_second) {}

  absl::Status TakeRequest(const std::string& identity, Time now);

  // The place of a call that stays open, given back with the last copy. Must not outlive this.
  absl::StatusOr<std::shared_ptr<const void>> TakeStream(const std::string& identity);

  // The same for an answer of a unary call, until its client has taken it. There may be as many of
  // them as of calls that stay open, beside those.
  absl::StatusOr<std::shared_ptr<const void>> TakeAnswer(const std::string& identity);

  const QuotaLimits& limits() const { return limits_; }

 private:
  // How many of a kind there are.
  struct Count {
    std::size_t all = 0;
    std::map<std::string, std::size_t> by_identity;
  };
  using Refusal = absl::Status (*)(std::size_t maximum, const char* whose);

  absl::StatusOr<std::shared_ptr<const void>> Take(const std::string& identity, Count& count,
                                                   Refusal refusal);
  void GiveBack(const std::string& identity, Count& count);

  const QuotaLimits limits_;
  std::mutex mutex_;
  base::Allowances requests_;
  Count streams_;
  Count answers_;
};

}  // namespace thunderhead::access
