// The position of a top-down picture in the map projection of its model. Plane coordinates are
// metres east and north of the projection's origin. Storm coordinates are metres from the middle of
// the domain. The two differ only by a shift, because a model's grid is regular in its projection.
#pragma once

#include <string>

#include "glm/vec2.hpp"

namespace thunderhead::product {

// The position of a picture with the grid's north up. Coordinates are plane coordinates, or metres
// from the middle of the domain if there is no projection.
struct MapPlace {
  std::string projection;        // in PROJ's notation
  glm::dvec2 upper_left_m{0.0};  // upper left corner of the first pixel, not its centre
  glm::dvec2 pixel_m{0.0};       // width and height of a pixel

  // Returns the coordinates of a pixel's centre. Columns and rows are counted from the upper left.
  glm::dvec2 MiddleOf_m(int column, int row) const {
    return {upper_left_m.x + (column + 0.5) * pixel_m.x, upper_left_m.y - (row + 0.5) * pixel_m.y};
  }
};

// Returns the six lines of a world file, a text file next to a picture that gives GIS programs its
// position.
std::string WorldFile(const MapPlace& place);

}  // namespace thunderhead::product
