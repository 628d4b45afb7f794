// The input of the diffusion equation: the extinction of the medium in cells of equal size.
#pragma once

#include <cstddef>
#include <vector>

#include "glm/vec3.hpp"

namespace thunderhead::renderers {

// Values by cell, with x varying fastest.
struct DiffusionCells {
  glm::ivec3 size{0};
  glm::dvec3 cell_m{0.0};
  std::vector<float> light_per_m;
  std::vector<float> transport_per_m;
  std::vector<float> absorption_per_m;

  std::size_t Offset(const glm::ivec3& cell) const {
    return (static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(size.y) +
            static_cast<std::size_t>(cell.y)) *
               static_cast<std::size_t>(size.x) +
           static_cast<std::size_t>(cell.x);
  }
  bool Contains(const glm::ivec3& cell) const {
    return cell.x >= 0 && cell.y >= 0 && cell.z >= 0 && cell.x < size.x && cell.y < size.y &&
           cell.z < size.z;
  }
  glm::ivec3 CellAt(std::size_t offset) const {
    const auto at = static_cast<int>(offset);
    return {at % size.x, at / size.x % size.y, at / (size.x * size.y)};
  }
};

}  // namespace thunderhead::renderers
