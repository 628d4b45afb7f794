// How often one may do something, and each of many: a bucket that fills with time and holds two
// seconds' worth, so that who has rested may do twice as much at once.
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

  // Takes one. If there is none, the time until there is.
  std::optional<std::chrono::milliseconds> Take(Time now);
  // How many there are now.
  double LeftAt(Time now) const;
  // True if nothing was taken for so long that the bucket is as full as a new one.
  bool IsFull(Time now) const { return LeftAt(now) >= kBurst_s * per_second_; }

 private:
  static constexpr double kBurst_s = 2.0;

  double per_second_;
  double left_;
  Time at_;
};

// By name. Used by one thread at a time.
class Allowances {
 public:
  using Time = Allowance::Time;

  // 0: no limit.
  explicit Allowances(double per_second) : per_second_(per_second) {}

  // As Allowance::Take.
  std::optional<std::chrono::milliseconds> Take(const std::string& who, Time now);
  // False if there is none left.
  bool HasAny(const std::string& who, Time now) const;

  double PerSecond() const { return per_second_; }

 private:
  const double per_second_;
  std::map<std::string, Allowance> left_;
};

}  // namespace thunderhead::base
