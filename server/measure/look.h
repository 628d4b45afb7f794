// Figures of what a viewer sees of a storm: how many stops its sunlit tower and the whole picture
// span, and how dark its base is. A stop is a factor of 2.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "measure/image_error.h"
#include "picture/linear_picture.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::measure {

// The regions of a storm in a picture, relative to its strongest core (volume::StrongestCore) of
// height H. A pixel counts if the storm covers it (an opacity of 0.95). Its region depends on the
// place that it shows (scene::PlaceSeen, without detail):
//
//   tower  within H / 2 of the core's axis, higher than H / 6 above the ground, and sunlit
//
//   base   within H / 3 of the axis, not higher than H / 4 and 2 km, and not sunlit
//
// A place is sunlit if the optical depth towards the sun, beyond a distance of H / 8, is less than
// 1. So billows and the shadows between them belong to the sunlit tower, as in the usual
// description of photographs. The shaded side and the shadow of an anvil do not.
enum class Region : std::uint8_t { kNeither, kTower, kBase };

// Returns the region of each pixel, rows from top to bottom. `opacity` is the storm's opacity.
std::vector<Region> RegionsOf(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                              const std::vector<float>& opacity);

// Minimum number of pixels of a region.
inline constexpr int kFewestPixels = 50;

struct LookFigures {
  int tower_pixels = 0;
  int base_pixels = 0;
  std::optional<double> tower_stops;  // from the 5th to the 95th percentile of luminance
  double frame_stops = 0.0;           // of the whole picture, from the 1st to the 99th percentile
  std::optional<double> base_share;   // ratio of the base's median luminance to the tower's
};

LookFigures FiguresOf(const std::vector<Region>& regions, const picture::LinearPicture& picture);
// Returns the figures of the light that a screen shows. Black counts as half of the darkest grey.
LookFigures FiguresOf(const std::vector<Region>& regions, const frame::RgbImage& display);

}  // namespace thunderhead::measure
