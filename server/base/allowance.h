// Rate limits, for one client or for many. Each is a token bucket that refills with time and holds
// two seconds' worth of tokens. A client that has paused can therefore send a burst of twice its
// rate.
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

  // Takes one token. If there is none, returns the time until the next one.
  std::optional<std::chrono::milliseconds> Take(Time now);
  // Returns the number of tokens at `now`.
  double LeftAt(Time now) const;
  // Returns whether nothing was taken for so long that the bucket is as full as a new one.
  bool IsFull(Time now) const { return LeftAt(now) >= kBurst_s * per_second_; }

 private:
  static constexpr double kBurst_s = 2.0;

  double per_second_;
  double left_;
  Time at_;
};

// A rate limit for each name. It must be used by one thread at a time.
class Allowances {
 public:
  using Time = Allowance::Time;

  // With `per_second` = 0 there is no limit.
  explicit Allowances(double per_second) : per_second_(per_second) {}

  // Like Allowance::Take, from the bucket of `who`.
  std::optional<std::chrono::milliseconds> Take(const std::string& who, Time now);
  // Returns false if the bucket of `who` has no token left.
  bool HasAny(const std::string& who, Time now) const;

  double PerSecond() const { return per_second_; }

 private:
  const double per_second_;
  std::map<std::string, Allowance> left_;
};

}  // namespace thunderhead::base
