// A display picture with more than 8 bits a channel, for resting frames whose sky must not show
// bands.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/memory_budget.h"

namespace thunderhead::frame {

// 16-bit sRGB, three values a pixel, rows from top to bottom. It lacks the noise that 8-bit
// pictures have.
struct FineImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint16_t> rgb;
  // Counts the image's memory; null: not counted.
  std::shared_ptr<const base::MemoryReservation> memory;
};

}  // namespace thunderhead::frame
