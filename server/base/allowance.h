// Rate limits by token buckets, for one client or for many. A bucket refills at a constant rate and
// holds at most the tokens of two seconds. After a pause of two seconds, a client can therefore
// make the requests of two seconds at once.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

namespace thunderhead::base {

class Allowance {
 public:
  using Time = std::chrono::steady_clock::time_point;

  Allowance(double per_second, Time now)
      : per_second_(per_second), left_(kBurst_s * per_second), at_(now) {}

  // Takes one token and returns nothing. If the bucket has no token, returns the time until the
  // next token.
  std::optional<std::chrono::milliseconds> Take(Time now);
  // Returns the number of tokens at `now`.
  double LeftAt(Time now) const;
  // Returns whether the bucket is full, like a new bucket.
  bool IsFull(Time now) const { return LeftAt(now) >= kBurst_s * per_second_; }

 private:
  static constexpr double kBurst_s = 2.0;

  double per_second_;
  double left_;
  Time at_;
};

// A token bucket for each client name. The object must be used by one thread at a time.
class Allowances {
 public:
  using Time = Allowance::Time;

  // `per_second` is the rate for each name. 0 means no limit.
  explicit Allowances(double per_second) : per_second_(per_second) {}

  // Takes one token from the bucket of the client `who`, like Allowance::Take.
  std::optional<std::chrono::milliseconds> Take(const std::string& who, Time now);
  // Returns whether the bucket of the client `who` has a token. Takes no token.
  bool HasAny(const std::string& who, Time now) const;

  double PerSecond() const { return per_second_; }

 private:
  const double per_second_;
  std::map<std::string, Allowance> left_;
};

}  // namespace thunderhead::base
