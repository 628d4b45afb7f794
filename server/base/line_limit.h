// Limits how many lines a second are logged about events that others can cause as often as they
// like. A plain value that is given the time; callers that share it lock.
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

  // How many lines have been left out since the last one taken; nothing if that of `now` is to be
  // left out, too.
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
  int lines_ = 0;  // in it
  std::uint64_t left_out_ = 0;
};

}  // namespace thunderhead::base
