// Projects world points into a picture. The projection uses Frame.view, the camera of the shown
// frame. Picture coordinates: x is -1 at the left edge and 1 at the right edge; y is -1 at the
// bottom and 1 at the top.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "thunderhead/v1/frame.pb.h"
#include "thunderhead/v1/interact.pb.h"

namespace thunderhead::client {

struct PicturePoint {
  double x = 0.0;
  double y = 0.0;
};

// Returns a point's position in the picture. Returns nothing if the view is incomplete, or if the
// point is behind a perspective camera or less than a metre in front of it.
std::optional<PicturePoint> Project(const v1::View& view, const v1::Position& position);

// Returns the parts of a line that are in front of the camera. In a parallel view this is the whole
// line. Returns no parts if the view is incomplete.
std::vector<std::vector<PicturePoint>> ProjectLine(
    const v1::View& view, const google::protobuf::RepeatedPtrField<v1::Position>& positions);

v1::Ray RayAt(const v1::View& view, const PicturePoint& point);

}  // namespace thunderhead::client
