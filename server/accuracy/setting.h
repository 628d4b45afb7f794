// A setting whose accuracy and speed are measured. It consists of a technique, the size and
// precision of its buffers, the JPEG quality and the number of paths that correct the light.
#pragma once

#include <cstdint>

#include "scene/scene.h"
#include "scene/technique.h"

namespace thunderhead::accuracy {

// The number of paths that are traced for the light of a scene at rest. More paths change the
// visible result by less than one per cent.
inline constexpr std::int64_t kTracedPaths = 4'000'000;
// The number of paths that are traced before an image outside any session is drawn, if the image
// requests the path-traced correction but no maximum error.
inline constexpr std::int64_t kImagePaths = 1'000'000;

struct Setting {
  scene::Technique technique;
  double image_scale = 1.0;
  int jpeg_quality = scene::Output{}.jpeg_quality;
  double light_detail = 1.0;  // resolution of the light, as in renderers::DrawQuality
  bool single_precision = false;
  double million_paths = 0.0;  // millions of paths that correct the light; 0 without correction

  bool operator==(const Setting&) const = default;
};

// Returns the setting of a scene whose settings are final (Offers::Decide), at full quality and
// with all paths traced.
Setting SettingOf(const scene::Scene& scene);

// Returns the setting without path-traced correction. It is used to compare costs, because traced
// paths add nothing to a frame's cost.
Setting Untraced(Setting setting);

// These functions compare settings. SameModel returns true for the same technique and light model.
// SameDrawing also compares the number of slices, the image scale, and whether the light is traced.
// Turbulent detail is ignored because it does not change the mean light that tables compare.
bool SameModel(const scene::Technique& a, const scene::Technique& b);
bool SameDrawing(const Setting& a, const Setting& b);

// Returns how different two settings are: the number of factors of two between their numbers of
// slices, plus that between their image scales.
double Distance(const Setting& a, const Setting& b);

}  // namespace thunderhead::accuracy
