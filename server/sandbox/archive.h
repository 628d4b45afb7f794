// Plain values over a pipe, in the layout of this machine: both ends are the same program. What is
// received is never believed: no array is larger than its allowance, and no wait longer than its
// time.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "base/time_source.h"

namespace thunderhead::sandbox {

// True for what travels as its bytes.
template <typename Value>
concept Plain = std::is_trivially_copyable_v<Value> && !std::is_pointer_v<Value>;

// The end that writes; what cannot be written, as nobody reads any more, is dropped.
class Sender {
 public:
  explicit Sender(int pipe) : pipe_(pipe) {}

  template <Plain Value>
  void operator()(const Value& value) {
    Write(&value, sizeof(value));
  }
  void operator()(const std::string& text) { Array(text); }
  template <Plain Value>
  void operator()(const std::vector<Value>& values) {
    Array(values);
  }

 private:
  template <typename Values>
  void Array(const Values& values) {
    (*this)(static_cast<std::uint64_t>(values.size()));
    Write(values.data(), values.size() * sizeof(values[0]));
  }
  void Write(const void* bytes, std::size_t count);

  const int pipe_;
};

// The end that reads. After a failure every value is that of its type's zero.
class Receiver {
 public:
  enum class Failure { kNone, kEnded, kTooLarge, kTooLate };

  // Waits for `patience` in all, by `time`; takes arrays of `allowance` bytes in all.
  Receiver(int pipe, std::chrono::milliseconds patience, std::uint64_t allowance,
           const base::TimeSource& time = base::SteadyTime())
      : pipe_(pipe), time_(time), patience_(patience), allowance_(allowance) {}

  template <Plain Value>
  void operator()(Value& value) {
    if (!Read(&value, sizeof(value))) value = Value{};
  }
  // Texts are for people, so they are short.
  void operator()(std::string& text) { Array(text, kLongestText); }
  template <Plain Value>
  void operator()(std::vector<Value>& values) {
    Array(values, allowance_ / sizeof(Value));
  }

  bool Ok() const { return failure_ == Failure::kNone; }
  Failure Why() const { return failure_; }

  // Marks data as invalid that could be received.
  void Refuse() {
    if (Ok()) failure_ = Failure::kTooLarge;
  }

 private:
  static constexpr std::uint64_t kLongestText = 16 << 10;

  template <typename Values>
  void Array(Values& values, std::uint64_t most) {
    std::uint64_t count = 0;
    (*this)(count);
    const std::size_t each = sizeof(values[0]);
    values.clear();
    if (count > most || count * each > allowance_) return Refuse();
    allowance_ -= count * each;
    values.resize(count);
    if (!Read(values.data(), count * each)) values.clear();
  }
  bool Read(void* bytes, std::size_t count);
  bool AwaitBytes();

  const int pipe_;
  const base::TimeSource& time_;
  std::chrono::nanoseconds patience_;
  std::uint64_t allowance_;
  Failure failure_ = Failure::kNone;
};

}  // namespace thunderhead::sandbox
