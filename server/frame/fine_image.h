// A display picture with more than 8 bits a channel, for resting frames whose sky must not show
// bands.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/memory_budget.h"

namespace thunderhead::frame {

// Pixels are 16-bit sRGB, three values a pixel, rows from top to bottom. They have no dither noise,
// unlike 8-bit pictures.
struct FineImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint16_t> rgb;
  // The reservation that counts the image's memory. If it is null, the memory is not counted.
  std::shared_ptr<const base::MemoryReservation> memory;
};

}  // namespace thunderhead::frame
