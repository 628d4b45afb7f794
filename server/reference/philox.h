// Counter-based random numbers: Philox 4x32-10 (Salmon et al. 2011, "Parallel random numbers: as
// easy as 1, 2, 3"). A number depends only on its key and its index in the sequence, so results are
// the same for any number of threads.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace thunderhead::reference {

using PhiloxBlock = std::array<std::uint32_t, 4>;
using PhiloxKey = std::array<std::uint32_t, 2>;

// Applies ten rounds of Philox to `counter`.
inline PhiloxBlock Philox4x32(PhiloxBlock counter, PhiloxKey key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t product_0 = std::uint64_t{0xD2511F53U} * counter[0];
    const std::uint64_t product_1 = std::uint64_t{0xCD9E8D57U} * counter[2];
    counter = {static_cast<std::uint32_t>(product_1 >> 32U) ^ counter[1] ^ key[0],
               static_cast<std::uint32_t>(product_1),
               static_cast<std::uint32_t>(product_0 >> 32U) ^ counter[3] ^ key[1],
               static_cast<std::uint32_t>(product_0)};
    key[0] += 0x9E3779B9U;
    key[1] += 0xBB67AE85U;
  }
  return counter;
}

// The random numbers of one path. `item` is the index of its pixel or photon, `sample` its index
// among the paths of that item. Successive calls return successive numbers of the path.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t item, std::uint32_t sample)
      : key_{Low(seed), High(seed)}, counter_{0, sample, Low(item), High(item)} {}

  // Returns a number uniform over (0, 1), in steps of 2^-32. It is never 0 or 1.
  double Uniform() { return (Word() + 0.5) * 0x1p-32; }

  // Returns an exponentially distributed number with mean 1. It uses 53 random bits, because
  // optically thin media need very small values.
  double Exponential() {
    const std::uint64_t high = Word();
    const std::uint64_t bits = ((high << 32U) | Word()) >> 11U;
    return -std::log1p(-(static_cast<double>(bits) + 0.5) * 0x1p-53);
  }

 private:
  static std::uint32_t Low(std::uint64_t value) { return static_cast<std::uint32_t>(value); }
  static std::uint32_t High(std::uint64_t value) {
    return static_cast<std::uint32_t>(value >> 32U);
  }

  std::uint32_t Word() {
    if (used_ == block_.size()) {
      block_ = Philox4x32(counter_, key_);
      ++counter_[0];
      used_ = 0;
    }
    return block_[used_++];
  }

  PhiloxKey key_;
  PhiloxBlock counter_;
  PhiloxBlock block_{};
  std::size_t used_ = 4;
};

}  // namespace thunderhead::reference
