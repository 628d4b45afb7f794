// The geometry of an ice crystal: a hexagonal prism about the z axis with its centre at the origin.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "glm/vec3.hpp"

namespace thunderhead::physics {

class HexagonalPrism {
 public:
  static constexpr std::size_t kFaces = 8;  // six sides, then the bases at +z and -z

  // `width` is the distance between opposite edges, `length` is along the axis.
  HexagonalPrism(double width, double length);

  // Returns the outward normal of a face.
  const glm::dvec3& Normal(std::size_t face) const { return normals_[face]; }

  double Area(std::size_t face) const { return face < 6 ? side_area_ : base_area_; }

  // Returns the corners of a face in order around it.
  std::vector<glm::dvec3> Corners(std::size_t face) const;

  // Returns the area of the prism's projection along a direction.
  double ProjectedArea(const glm::dvec3& direction) const;

  // Returns a point on a face. It is distributed uniformly over the face for uniform `u` and `v` in
  // [0, 1).
  glm::dvec3 PointOn(std::size_t face, double u, double v) const;

  // The face through which a line leaves the prism, and the distance to it. The line starts at a
  // point inside or on the prism.
  struct Exit {
    std::size_t face;
    double distance;
  };
  Exit ExitOf(const glm::dvec3& point, const glm::dvec3& direction) const;

 private:
  // Vector from the axis to edge number `corner` (0 to 5).
  glm::dvec3 Edge(std::size_t corner) const;

  double edge_;  // edge length of the hexagon: half its width
  double half_length_;
  double side_area_;
  double base_area_;
  std::array<glm::dvec3, kFaces> normals_;
  std::array<double, kFaces> offsets_;  // distances of the faces' planes from the centre
};

}  // namespace thunderhead::physics
