#include "thunderhead_client/back_off.h"

#include <algorithm>

namespace thunderhead::client {

std::chrono::milliseconds BackOff::Next(std::chrono::milliseconds least) {
  constexpr int kMaxDoublings = 16;
  const auto bound =
      std::min(kLongestBound, kFirstBound * (1 << std::min(attempts_, kMaxDoublings)));
  ++attempts_;
  std::uniform_int_distribution<std::chrono::milliseconds::rep> delay(0, bound.count());
  return least + std::chrono::milliseconds(delay(random_));
}

}  // namespace thunderhead::client
