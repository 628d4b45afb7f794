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
  using Time = std::chrono::steady_clock::time_point;

  // `per_second` 0: no limit.
  RequestBudget(double per_second, Time now) : left_(kBurst_s * per_second), at_(now) {}

  // RESOURCE_EXHAUSTED if there is none left.
  absl::Status Take(double per_second, Time now);
  // How many there are now.
  double LeftAt(double per_second, Time now) const;
  // True if nothing was taken for so long that the bucket is as full as a new one.
  bool IsFull(double per_second, Time now) const;

 private:
  static constexpr double kBurst_s = 2.0;

  double left_;
  Time at_;
};

class Quotas {
 public:
  using Time = RequestBudget::Time;

  explicit Quotas(const QuotaLimits& limits) : limits_(limits) {}

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
  using TooMany = absl::Status (*)(std::size_t maximum, const char* whose);

  absl::StatusOr<std::shared_ptr<const void>> Take(const std::string& identity, Count& count,
                                                   TooMany too_many);
  void GiveBack(const std::string& identity, Count& count);

  const QuotaLimits limits_;
  std::mutex mutex_;
  Count streams_;
  Count answers_;
  std::map<std::string, RequestBudget> budgets_;
};

}  // namespace thunderhead::access
