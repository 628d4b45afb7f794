#include "thunderhead_client/back_off.h"

#include <algorithm>
#include <random>

namespace thunderhead::client {

BackOff::BackOff()
    : random_([engine = std::mt19937(std::random_device{}())]() mutable {
        return std::uniform_real_distribution<double>(0.0, 1.0)(engine);
      }) {}

std::chrono::milliseconds BackOff::Next(std::chrono::milliseconds least) {
  constexpr int kMaxDoublings = 16;
  const auto bound =
      std::min(kLongestBound, kFirstBound * (1 << std::min(attempts_, kMaxDoublings)));
  ++attempts_;
  return least + std::chrono::duration_cast<std::chrono::milliseconds>(bound * random_());
}

}  // namespace thunderhead::client
