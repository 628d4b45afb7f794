// Limits how many lines are logged per second about events that clients can trigger as often as
// they like. A plain value type to which the caller passes the time. Callers that share it must
// lock.
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

  // Returns how many lines have been dropped since the last line that was allowed. Returns nothing
  // if the line of `now` must be dropped, too.
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
  int lines_ = 0;  // logged in second_
  std::uint64_t left_out_ = 0;
};

}  // namespace thunderhead::base
