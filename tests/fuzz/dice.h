// Random choices that are the same on every machine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>

namespace thunderhead::testing {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  std::size_t Below(std::size_t end) { return end == 0 ? 0 : random_() % end; }
  bool OneIn(std::size_t many) { return Below(many) == 0; }
  template <typename Value, std::size_t kCount>
  Value Of(const std::array<Value, kCount>& values) {
    return values[Below(kCount)];
  }

 private:
  std::mt19937_64 random_;
};

}  // namespace thunderhead::testing
