// Splits a mark, which people draw over the picture, into its strokes. The web page joins all
// strokes of a mark to one line. A corner that occurs twice in succession means that the pen is
// lifted and moves to the next corner (client-web/src/core/lettering.ts).
#pragma once

#include <vector>

#include "thunderhead/v1/frame.pb.h"
#include "thunderhead/v1/interact.pb.h"
#include "thunderhead_client/projection.h"

namespace thunderhead::desktop {

struct MarkStroke {
  // True for a hand-drawn line, which is thick. Arrows and letters consist of thin, straight
  // strokes.
  bool ink = false;
  std::vector<client::PicturePoint> points;
};

std::vector<MarkStroke> StrokesOf(const v1::Mark& mark, const v1::View& view);

}  // namespace thunderhead::desktop
