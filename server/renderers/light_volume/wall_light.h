// Light that the walls of thick clouds send each other through air that scatters little. A wall is
// a cell of dense cloud at the cloud's surface. The diffusion equation cannot carry this light,
// because it does not model light that travels far without being scattered. Walls count as white:
// they send out all the light that arrives from other walls, in addition to their own. The code
// works with plain values on the CPU and does not use GL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderers/light_volume/diffusion_cells.h"
#include "renderers/light_volume/fringe.h"

namespace thunderhead::renderers {

class WallLight {
 public:
  explicit WallLight(const DiffusionCells& cells);

  // Returns for each wall the share of the hemisphere in front of its open faces that other walls
  // cover. The share is 0 for cells that are not walls.
  const std::vector<float>& Hidden() const { return hidden_; }

  // Sets `arriving` of each wall to the light from other walls. Cells next to walls get the mean of
  // those walls. Other cells stay unchanged. `own` is the light that each cell sends out apart from
  // this exchange. Both are fluences at a white surface, which are four times the flux that arrives
  // there.
  void FindArriving(const std::vector<float>& own, std::vector<float>* arriving) const;

 private:
  // The part of the hemisphere in front of one wall that another wall covers.
  struct Seen {
    std::int32_t from;
    std::int32_t to;
    float share;  // share of the whole hemisphere in front of the open faces of wall `from`
    std::int32_t to_wall = -1;  // index of `to` in walls_; -1 if that wall sees no other walls
  };

  bool IsWall(const DiffusionCells& cells, std::size_t cell) const;
  void Look(const DiffusionCells& cells, std::size_t wall);
  void NumberWalls();
  glm::dvec3 Outward(const DiffusionCells& cells, std::size_t wall) const;
  static float NearShare(const DiffusionCells& cells, std::size_t wall, const glm::ivec3& other,
                         const glm::dvec3& outward);
  // Follows a ray from side `side` of a wall, and records in seen_ the wall that the ray meets. The
  // parameter `outward` is the outward direction of the cloud surface that the wall belongs to.
  void Follow(const DiffusionCells& cells, std::size_t wall, int side, const glm::dvec3& ray,
              const glm::dvec3& outward);

  double wall_size_m_ = 0.0;
  float wall_per_m_ = 0.0F;
  std::vector<Seen> seen_;           // sorted by `from`
  std::vector<std::int32_t> walls_;  // the walls that see other walls
  // For each of walls_, the index of its first entry in seen_; finally the size of seen_.
  std::vector<std::size_t> first_seen_;
  std::vector<float> hidden_;
  Fringe beside_walls_;
};

}  // namespace thunderhead::renderers
