// Light that thick clouds' walls send each other through air that scatters little: what the
// diffusion equation, which knows no free flight, cannot carry. Walls are taken for white, so that
// what they send on does not depend on how much comes in. Plain values on the CPU; knows no GL.
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

  // For each cell, the share of what a wall's open faces see that is other walls; 0 elsewhere.
  const std::vector<float>& Hidden() const { return hidden_; }

  // Sets `arriving` of walls to the light that comes in from other walls, and of the cells beside
  // them to that of the walls there; other cells stay as they are. `own` is what each cell sends
  // out besides. Both are fluences that give the same flux to a white surface: four times it.
  void FindArriving(const std::vector<float>& own, std::vector<float>* arriving) const;

 private:
  // The part of a wall's view that another wall takes.
  struct Seen {
    std::int32_t from;
    std::int32_t to;
    float share;                // of all that its open faces see
    std::int32_t to_wall = -1;  // in walls_; none if that wall sees no others
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
  std::vector<std::int32_t> walls_;      // those that see others
  std::vector<std::size_t> first_seen_;  // in seen_, of each of these, and the end
  std::vector<float> hidden_;
  Fringe beside_walls_;
};

}  // namespace thunderhead::renderers
