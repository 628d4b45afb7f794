// Limits for the requests of each identity and of all identities together: the number of calls that
// stay open, and requests per second. Each refusal is RESOURCE_EXHAUSTED with a retry delay. Safe
// from any thread.
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
  // The maximum mean rate of requests for one identity. After a pause, the requests of two seconds
  // are allowed at once. 0 means no limit.
  double requests_per_second = 500.0;
  // The maximum rate of invalid tokens from one network. Beyond it, the network may only present
  // tokens that were valid before.
  double wrong_tokens_per_second = 5.0;
};

// A budget of requests that refills with time.
class RequestBudget {
 public:
  using Time = base::Allowance::Time;

  // With `per_second` = 0 there is no limit.
  RequestBudget(double per_second, Time now) : per_second_(per_second), left_(per_second, now) {}

  // Returns RESOURCE_EXHAUSTED if no request is left.
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

  // Reserves a place for a call that stays open (a stream). The place is released when the last
  // copy of the result is destroyed. The result must not outlive this object.
  absl::StatusOr<std::shared_ptr<const void>> TakeStream(const std::string& identity);

  // Reserves a place for a finished response of a unary call, until its client has received it.
  // Responses are counted separately from streams, with the same limits.
  absl::StatusOr<std::shared_ptr<const void>> TakeAnswer(const std::string& identity);

  const QuotaLimits& limits() const { return limits_; }

 private:
  // Number of places that calls of one kind hold, in total and for each identity.
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
