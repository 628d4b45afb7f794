// Annotations burnt into a picture for those who see nothing else: texts by Pango, in the picture's
// corners, white with a dark edge, so that they can be read on any sky.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "frame/image_codec.h"
#include "glm/vec3.hpp"
#include "product/logo.h"

namespace thunderhead::product {

// A colour and what it stands for.
struct LegendEntry {
  std::string name;
  glm::vec3 color{1.0F};  // linear sRGB
};

// Texts are UTF-8; one that is too long for the picture ends in an ellipsis.
struct Annotation {
  std::string title;                // upper left
  std::string run;                  // below it; may be empty
  std::string valid_time;           // lower left
  std::vector<LegendEntry> legend;  // lower right, the first entry on top
  const Logo* logo = nullptr;       // upper right, at most a sixth of the picture high; may be null
};

// Height of the text's line in a picture of that height.
double TextHeight_px(int picture_height_px);

// Draws it. FAILED_PRECONDITION if there is no font on this machine.
absl::Status Annotate(const Annotation& annotation, frame::RgbImage& image);

}  // namespace thunderhead::product
