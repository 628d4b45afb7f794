// Where world points are in a picture, and which rays its pixels stand for, by Frame.view. x and y
// are -1 at the picture's left and bottom edge, 1 at the right and top.
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

// Nothing for a point behind the eye, or a view that is not whole.
std::optional<PicturePoint> Project(const v1::View& view, const v1::Position& position);

// The visible parts of a line: what is behind the eye is cut off. None in a view that is not whole.
std::vector<std::vector<PicturePoint>> ProjectLine(
    const v1::View& view, const google::protobuf::RepeatedPtrField<v1::Position>& positions);

v1::Ray RayAt(const v1::View& view, const PicturePoint& point);

}  // namespace thunderhead::client
