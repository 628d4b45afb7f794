// A setting whose accuracy and speed are measured. It consists of a technique, the size and
// precision of its buffers, the JPEG quality and the number of paths that correct the light.
#pragma once

#include <cstdint>

#include "scene/scene.h"
#include "scene/technique.h"

namespace thunderhead::accuracy {

// Number of paths traced for a view at rest if its light is traced. More paths change the visible
// result by less than a hundredth.
inline constexpr std::int64_t kTracedPaths = 4'000'000;
// Number of paths that an image outside any session waits for if it requests no error.
inline constexpr std::int64_t kImagePaths = 1'000'000;

struct Setting {
  scene::Technique technique;
  double image_scale = 1.0;
  int jpeg_quality = scene::Output{}.jpeg_quality;
  double light_detail = 1.0;  // as in renderers::DrawQuality
  bool single_precision = false;
  double million_paths = 0.0;  // of traced light

  bool operator==(const Setting&) const = default;
};

// Returns the final setting of a decided scene, at full quality and with all paths traced.
Setting SettingOf(const scene::Scene& scene);

// Returns the setting without traced light, because paths add nothing to a frame's cost.
Setting Untraced(Setting setting);

// Return true for the same technique, light model and buffers, both traced or both not traced.
// Turbulent detail is ignored because it does not change the mean light that tables compare.
bool SameModel(const scene::Technique& a, const scene::Technique& b);
bool SameDrawing(const Setting& a, const Setting& b);

// Returns the distance as the number of factors of two between the settings' slices and image
// scales.
double Distance(const Setting& a, const Setting& b);

}  // namespace thunderhead::accuracy
