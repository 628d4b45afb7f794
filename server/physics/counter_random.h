// Random numbers that are a pure function of a key and a counter. A computation therefore gives the
// same bits in any order and on any number of threads.
#pragma once

#include <cstdint>

namespace thunderhead::physics {

// One stream of uniform numbers. The mixing function is that of SplitMix64 (Steele, Lea and Flood
// 2014).
class CounterRandom {
 public:
  CounterRandom(std::uint64_t seed, std::uint64_t stream)
      : key_(Mix(Mix(seed + kStep) ^ (stream * kStep))) {}

  // Returns the next number, at least 0 and below 1.
  double Next() {
    counter_ += kStep;
    return static_cast<double>(Mix(key_ + counter_) >> 11U) * 0x1p-53;
  }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15U;

  static constexpr std::uint64_t Mix(std::uint64_t z) {
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }

  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

}  // namespace thunderhead::physics
