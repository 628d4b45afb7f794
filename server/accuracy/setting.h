// A setting that accuracy and speed are measured of: a technique with the size and precision of its
// buffers, the quality of the JPEG and the paths that correct the light.
#pragma once

#include "scene/technique.h"

namespace thunderhead::accuracy {

struct Setting {
  scene::Technique technique;
  double image_scale = 1.0;
  int jpeg_quality = 88;
  double light_detail = 1.0;  // as in renderers::DrawQuality
  bool single_precision = false;
  double million_paths = 0.0;  // of traced light

  bool operator==(const Setting&) const = default;
};

}  // namespace thunderhead::accuracy
