// Limits for the requests of each identity and of all identities together. They limit the number of
// calls that stay open, the memory of messages that clients have not read, and requests per second.
// Each refusal is RESOURCE_EXHAUSTED with a retry delay. Safe from any thread.
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
  // The maximum memory of messages that wait for clients to read them, in total and for one
  // identity. An identity without such a message may always have one, however large, while the
  // total is below its maximum.
  std::size_t max_unread_bytes = std::size_t{1024} << 20;
  std::size_t max_unread_bytes_per_identity = std::size_t{256} << 20;
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

  // Reserves a place for a finished response of a unary call that occupies `bytes` of memory, until
  // its client has received it. Responses are counted separately from streams, with the same
  // limits. The memory is reserved, too.
  absl::StatusOr<std::shared_ptr<const void>> TakeAnswer(const std::string& identity,
                                                         std::size_t bytes);

  // Reserves the memory of a message, until its client has received it. Returns null for a message
  // up to kSmallMessage_bytes. The result must not outlive this object.
  absl::StatusOr<std::shared_ptr<const void>> TakeUnread(const std::string& identity,
                                                         std::size_t bytes);

  // Messages up to this size are limited only by the number of calls. Clients that do not read
  // large messages therefore cannot keep others from getting small ones.
  static constexpr std::size_t kSmallMessage_bytes = std::size_t{64} << 10;

  const QuotaLimits& limits() const { return limits_; }

 private:
  // Number of places that calls of one kind hold, or of bytes that messages occupy, in total and
  // for each identity.
  struct Count {
    std::size_t all = 0;
    std::map<std::string, std::size_t> by_identity;
  };
  using Refusal = absl::Status (*)(std::size_t maximum, const char* whose);

  absl::StatusOr<std::shared_ptr<const void>> Take(const std::string& identity, Count& count,
                                                   Refusal refusal);
  // Adds `amount` to the count until the last copy of the result is destroyed. The caller must hold
  // mutex_.
  std::shared_ptr<const void> Hold(const std::string& identity, Count& count, std::size_t amount);
  void GiveBack(const std::string& identity, Count& count, std::size_t amount);

  const QuotaLimits limits_;
  std::mutex mutex_;
  base::Allowances requests_;
  Count streams_;
  Count answers_;
  Count unread_bytes_;
};

}  // namespace thunderhead::access
