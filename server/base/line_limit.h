// Limits how many lines are logged per second about events that clients can trigger as often as
// they like. It is a plain value type; the caller passes the time. Threads that share an object
// must hold a lock.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>

namespace thunderhead::base {

class LineLimit {
 public:
  using TimePoint = std::chrono::system_clock::time_point;

  explicit LineLimit(int lines_per_second) : most_(lines_per_second) {}

  // Decides whether a line may be written at `now`. If it may, returns how many lines were dropped
  // since the last allowed line. Otherwise returns nothing, and the caller drops the line.
  std::optional<std::uint64_t> Take(TimePoint now) {
    const auto second = std::chrono::floor<std::chrono::seconds>(now);
    if (second != second_) {
      second_ = second;
      lines_ = 0;
    }
    if (++lines_ <= most_) return std::exchange(left_out_, 0);
    ++left_out_;
    return std::nullopt;
  }

 private:
  const int most_;
  std::chrono::sys_seconds second_{};
  int lines_ = 0;  // lines requested in second_
  std::uint64_t left_out_ = 0;
};

}  // namespace thunderhead::base
