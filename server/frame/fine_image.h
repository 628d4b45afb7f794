// A display picture with more than 8 bits a channel, for stills whose sky must not band.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/memory_budget.h"

namespace thunderhead::frame {

// sRGB of 16 bits, three values a pixel, rows from top to bottom, without the noise that pictures
// of 8 bits have.
struct FineImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint16_t> rgb;
  std::shared_ptr<const base::MemoryReservation> memory;  // that it counts in; null: in none
};

}  // namespace thunderhead::frame
