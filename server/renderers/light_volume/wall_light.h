// Light that thick clouds' walls send each other through air that scatters little. The diffusion
// equation cannot carry it, because it has no free flight. Walls count as white, so the light that
// they send does not depend on how much arrives. The code works with plain values on the CPU and
// does not use GL.
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

  // Returns, for each cell, the share of the view of a wall's open faces that other walls take. It
  // is 0 for other cells.
  const std::vector<float>& Hidden() const { return hidden_; }

  // Sets `arriving` of walls to the light from other walls. Cells next to walls get the value of
  // those walls. Other cells stay unchanged. `own` is the other light that each cell sends out.
  // Both are fluences that give the same flux to a white surface: four times that flux.
  void FindArriving(const std::vector<float>& own, std::vector<float>* arriving) const;

 private:
  // The part of a wall's view that another wall takes.
  struct Seen {
    std::int32_t from;
    std::int32_t to;
    float share;                // relative to the whole view of its open faces
    std::int32_t to_wall = -1;  // index in walls_; -1 if that wall sees no others
  };

  bool IsWall(const DiffusionCells& cells, std::size_t cell) const;
  void Look(const DiffusionCells& cells, std::size_t wall);
  void NumberWalls();
  glm::dvec3 Outward(const DiffusionCells& cells, std::size_t wall) const;
  static float NearShare(const DiffusionCells& cells, std::size_t wall, const glm::ivec3& other,
                         const glm::dvec3& outward);
  // `outward` is that of the slope that the wall belongs to.
  void Follow(const DiffusionCells& cells, std::size_t wall, int side, const glm::dvec3& ray,
              const glm::dvec3& outward);

  double wall_size_m_ = 0.0;
  float wall_per_m_ = 0.0F;
  std::vector<Seen> seen_;               // ordered by `from`
  std::vector<std::int32_t> walls_;      // the walls that see others
  std::vector<std::size_t> first_seen_;  // start in seen_ of each of walls_, and the end
  std::vector<float> hidden_;
  Fringe beside_walls_;
};

}  // namespace thunderhead::renderers
