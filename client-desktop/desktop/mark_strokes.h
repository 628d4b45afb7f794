// Marks in a picture as strokes, which the page joins to one line: where a corner is repeated, the
// pen is lifted to the next one (client-web/src/core/lettering.ts).
#pragma once

#include <vector>

#include "thunderhead/v1/frame.pb.h"
#include "thunderhead/v1/interact.pb.h"
#include "thunderhead_client/projection.h"

namespace thunderhead::desktop {

struct MarkStroke {
  // A line drawn by hand is thick as of ink; arrows and letters are of thin, straight strokes.
  bool ink = false;
  std::vector<client::PicturePoint> points;
};

std::vector<MarkStroke> StrokesOf(const v1::Mark& mark, const v1::View& view);

}  // namespace thunderhead::desktop
