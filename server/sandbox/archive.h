// Sends plain values over a pipe to a process of the same build. Values are sent as their bytes in
// memory. Large arrays are placed one after another in memory that both processes share, and only
// their sizes go through the pipe. The receiver does not trust the sender, so it limits the size of
// all arrays and the time that it waits.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/time_source.h"

namespace thunderhead::sandbox {

// A type that is sent as its bytes.
template <typename Value>
concept Plain = std::is_trivially_copyable_v<Value> && !std::is_pointer_v<Value>;

// Computes the place of each large array in the shared memory. Sender and receiver each compute the
// places, so places are not sent.
class SharedPlaces {
 public:
  explicit SharedPlaces(std::size_t size) : size_(size) {}

  // Returns the offset of the next array, of `bytes` bytes. Returns nothing if the array goes
  // through the pipe, because the array is small or the remaining shared memory is too small for
  // it.
  std::optional<std::size_t> Next(std::size_t bytes);

 private:
  const std::size_t size_;
  std::size_t used_ = 0;
};

// Makes the kernel provide all pages of `memory` at once. This is faster than providing each page
// at its first use. A kernel that does not support the request ignores it.
enum class Use { kReading, kWriting };
void Populate(std::span<const std::byte> memory, Use use);

// Advises the kernel to use pages of 2 MB for the memory of a large array that is about to be
// written.
void PrepareForArray(std::span<std::byte> memory);

// The sending end of the pipe. If the receiving process has ended, values are dropped silently.
class Sender {
 public:
  explicit Sender(int pipe, std::span<std::byte> shared = {})
      : pipe_(pipe), shared_(shared), places_(shared.size()) {}

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
    const std::size_t bytes = values.size() * sizeof(values[0]);
    // An array in shared memory is written before its size is sent, because the receiver may read
    // the array once it has the size.
    const std::optional<std::size_t> place = places_.Next(bytes);
    if (place.has_value()) {
      const std::span<std::byte> to = shared_.subspan(*place, bytes);
      Populate(to, Use::kWriting);
      std::memcpy(to.data(), values.data(), bytes);
    }
    (*this)(static_cast<std::uint64_t>(values.size()));
    if (!place.has_value()) Write(values.data(), bytes);
  }
  void Write(const void* bytes, std::size_t count);

  const int pipe_;
  const std::span<std::byte> shared_;
  SharedPlaces places_;
};

// The receiving end of the pipe. After a failure every received value is the zero of its type.
class Receiver {
 public:
  enum class Failure { kNone, kEnded, kTooLarge, kTooLate, kSilent, kStopped };

  // Creates a receiver that waits for at most `patience` in total, measured by `time`, and accepts
  // arrays of at most `allowance` bytes in total.
  Receiver(int pipe, std::chrono::milliseconds patience, std::uint64_t allowance,
           const base::TimeSource& time = base::SteadyTime(),
           std::span<const std::byte> shared = {})
      : pipe_(pipe),
        time_(time),
        patience_(patience),
        allowance_(allowance),
        shared_(shared),
        places_(shared.size()) {}

  // Limits how long the sender may send nothing. After `longest` without data, the receiver calls
  // `is_excused`, which returns whether the sender has a valid reason. If it does, another period
  // of `longest` begins. Otherwise the receiver fails with kSilent.
  void LimitSilence(std::chrono::nanoseconds longest, std::function<bool()> is_excused) {
    longest_silence_ = longest;
    is_excused_ = std::move(is_excused);
  }

  // Makes the receiver fail with kStopped within a tenth of a second after `stop` is requested.
  void StopOn(std::stop_token stop) { stop_ = std::move(stop); }

  template <Plain Value>
  void operator()(Value& value) {
    if (!Read(&value, sizeof(value))) value = Value{};
  }
  // Texts are names and messages, so their length is limited to kLongestText.
  void operator()(std::string& text) { Array(text, kLongestText); }
  template <Plain Value>
  void operator()(std::vector<Value>& values) {
    Array(values, allowance_ / sizeof(Value));
  }

  bool Ok() const { return failure_ == Failure::kNone; }
  Failure Why() const { return failure_; }
  bool AnythingCame() const { return anything_came_; }

  // Marks received data as invalid.
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
    if (!Ok()) return;
    using Value = typename Values::value_type;
    if (const auto place = places_.Next(count * each); place.has_value()) {
      // The array is copied before it is checked, because the sender can still change the shared
      // memory.
      Populate(shared_.subspan(*place, count * each), Use::kReading);
      values.reserve(count);
      PrepareForArray({reinterpret_cast<std::byte*>(values.data()), count * each});
      const auto* const first = reinterpret_cast<const Value*>(shared_.data() + *place);
      values.assign(first, first + count);
      return;
    }
    values.resize(count);
    if (!Read(values.data(), count * each)) values.clear();
  }
  bool Read(void* bytes, std::size_t count);
  bool AwaitBytes();

  const int pipe_;
  const base::TimeSource& time_;
  std::chrono::nanoseconds patience_;
  std::chrono::nanoseconds longest_silence_ = std::chrono::nanoseconds::max();
  std::chrono::nanoseconds silence_{0};
  std::function<bool()> is_excused_;
  std::stop_token stop_;
  std::uint64_t allowance_;
  const std::span<const std::byte> shared_;
  SharedPlaces places_;
  bool anything_came_ = false;
  Failure failure_ = Failure::kNone;
};

}  // namespace thunderhead::sandbox
