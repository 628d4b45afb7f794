// A setting that accuracy and speed are measured of: a technique with the size and precision of its
// buffers, the quality of the JPEG and the paths that correct the light.
#pragma once

#include <cstdint>

#include "scene/scene.h"
#include "scene/technique.h"

namespace thunderhead::accuracy {

// Paths that are traced for a view that rests, if its light is traced; more change what is seen by
// less than a hundredth.
inline constexpr std::int64_t kTracedPaths = 4'000'000;
// Paths that a picture outside any session waits for if it asks for no error.
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

// The setting that a decided scene is drawn with in the end, at full quality and all paths traced.
Setting SettingOf(const scene::Scene& scene);

// The setting without traced light: paths cost a frame nothing.
Setting Untraced(Setting setting);

// The same technique, model of light and buffers, traced or not alike. Turbulent detail does not
// count: it does not change the mean light that tables compare.
bool SameModel(const scene::Technique& a, const scene::Technique& b);
bool SameDrawing(const Setting& a, const Setting& b);

// Factors of two between the settings' slices and image scales.
double Distance(const Setting& a, const Setting& b);

}  // namespace thunderhead::accuracy
