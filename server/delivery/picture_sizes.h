// A picture in the sizes of all tiers (link_estimate.h). Each size is computed when it is first
// used. Safe from any thread.
#pragma once

#include <array>
#include <cstddef>
#include <mutex>
#include <optional>
#include <utility>

#include "delivery/link_estimate.h"
#include "frame/halved.h"

namespace thunderhead::delivery {

template <typename Image>
class PictureSizes {
 public:
  explicit PictureSizes(Image full) { sizes_[0] = std::move(full); }

  const Image& At(int tier) {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 1; i <= static_cast<std::size_t>(tier); ++i) {
      if (!sizes_[i].has_value()) sizes_[i] = frame::Halved(*sizes_[i - 1]);
    }
    return *sizes_[static_cast<std::size_t>(tier)];
  }

 private:
  std::mutex mutex_;
  std::array<std::optional<Image>, kTiers> sizes_;
};

}  // namespace thunderhead::delivery
