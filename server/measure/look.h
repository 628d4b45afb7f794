// Statistics of the luminance of a storm in a picture. They are the range in stops of its sunlit
// tower and of the whole picture, and the darkness of its base. A stop is a factor of 2.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "measure/image_error.h"
#include "picture/linear_picture.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::measure {

// The regions of a storm in a picture. H is the height of the storm's strongest core
// (volume::StrongestCore). Only pixels that the storm covers (with an opacity of at least 0.95)
// belong to a region. The region depends on the place that the pixel shows (scene::PlaceSeen,
// without detail):
//
//   tower  within H / 2 of the core's axis, higher than H / 6 above the ground, and sunlit
//
//   base   within H / 3 of the axis, not higher than H / 4 and 2 km, and not sunlit
//
// A place is sunlit if the optical depth from it towards the sun is less than 1. The first H / 8 of
// that path is not counted. Billows and the shadows between them therefore belong to the sunlit
// tower, as in the usual description of photographs. The shaded side and the shadow of an anvil do
// not.
enum class Region : std::uint8_t { kNeither, kTower, kBase };

// Returns the region of each pixel, rows from top to bottom. `opacity` is the storm's opacity.
std::vector<Region> RegionsOf(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                              const std::vector<float>& opacity);

// Minimum number of pixels in a region for which figures are computed.
inline constexpr int kFewestPixels = 50;

struct LookFigures {
  int tower_pixels = 0;
  int base_pixels = 0;
  // Stops of the tower, from the 5th to the 95th percentile of luminance.
  std::optional<double> tower_stops;
  // Stops of the whole picture, from the 1st to the 99th percentile of luminance.
  double frame_stops = 0.0;
  std::optional<double> base_share;  // ratio of the base's median luminance to the tower's
};

LookFigures FiguresOf(const std::vector<Region>& regions, const picture::LinearPicture& picture);
// Returns the figures of a display picture, from the light that a screen emits. Black counts as
// half of the darkest grey.
LookFigures FiguresOf(const std::vector<Region>& regions, const frame::RgbImage& display);

}  // namespace thunderhead::measure
