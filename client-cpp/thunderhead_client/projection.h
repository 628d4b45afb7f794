// Projects world points into a picture by Frame.view. The coordinate x is -1 at the picture's left
// edge and 1 at the right edge. The coordinate y is -1 at the bottom and 1 at the top.
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

// Returns the position in the picture; nothing if the point is behind the eye or the view is
// incomplete.
std::optional<PicturePoint> Project(const v1::View& view, const v1::Position& position);

// Returns the visible parts of a line, without those behind the eye; none if the view is
// incomplete.
std::vector<std::vector<PicturePoint>> ProjectLine(
    const v1::View& view, const google::protobuf::RepeatedPtrField<v1::Position>& positions);

v1::Ray RayAt(const v1::View& view, const PicturePoint& point);

}  // namespace thunderhead::client
