// Annotations drawn into a picture, for viewers who see only the picture. Pango draws the texts in
// the picture's corners, white with a dark outline, so that they are readable on any sky.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "frame/image_codec.h"
#include "glm/vec3.hpp"
#include "product/logo.h"

namespace thunderhead::product {

// A line of the legend: a colour and what it means.
struct LegendEntry {
  std::string name;
  glm::vec3 color{1.0F};  // linear sRGB
};

// Texts are UTF-8. A text that is too long for the picture ends in an ellipsis.
struct Annotation {
  std::string title;                // upper left
  std::string run;                  // below the title; may be empty
  std::string valid_time;           // lower left
  std::vector<LegendEntry> legend;  // lower right, first entry on top
  // In the upper right corner, at most a sixth of the picture's height and a quarter of its width;
  // may be null.
  const Logo* logo = nullptr;
};

// Returns the height of a text line, in pixels, for a picture of that height.
double TextHeight_px(int picture_height_px);

// Draws the annotation. Returns FAILED_PRECONDITION if this machine has no font, and
// RESOURCE_EXHAUSTED if there is not enough memory.
absl::Status Annotate(const Annotation& annotation, frame::RgbImage& image);

}  // namespace thunderhead::product
