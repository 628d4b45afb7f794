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

// A storm's strongest core (volume::StrongestCore), of height H, as a picture shows it. A
// pixel counts where the storm covers it (an opacity of 0.95) and the place that it shows
// (scene::PlaceSeen, without detail) is
//
//   tower  within H / 2 of the core's axis, higher than H / 6 above the ground, and sunlit;
//   base   within H / 3 of the axis, not higher than H / 4 and 2 km, and not sunlit.
//
// Sunlit: farther than H / 8 towards the sun there is less than an optical depth of 1. So billows
// and the shadows between them are parts of the sunlit tower, as they are of what is called so in a
// photograph, but the shaded side and the shadow of an anvil are not.
enum class Region : std::uint8_t { kNeither, kTower, kBase };

// The region of each pixel, rows from top to bottom. `opacity` is that of the storm.
std::vector<Region> RegionsOf(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                              const std::vector<float>& opacity);

// Fewer pixels than this are not a region.
inline constexpr int kFewestPixels = 50;

struct LookFigures {
  int tower_pixels = 0;
  int base_pixels = 0;
  std::optional<double> tower_stops;  // from the 5th to the 95th percentile of luminance
  double frame_stops = 0.0;           // of the whole picture, from the 1st to the 99th
  std::optional<double> base_share;   // median luminance of the base over that of the tower
};

LookFigures FiguresOf(const std::vector<Region>& regions, const picture::LinearPicture& picture);
// Figures of the light that a screen shows. Black counts as half of the darkest grey.
LookFigures FiguresOf(const std::vector<Region>& regions, const frame::RgbImage& display);

}  // namespace thunderhead::measure
