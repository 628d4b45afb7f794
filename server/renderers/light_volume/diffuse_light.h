// Light scattered many times, from the diffusion (P1) equation on the medium's cells: one linear
// system for each sun, one for the sky. Plain values on the CPU; knows no GL and no scene.
//
// Optical depths are of two kinds. Those of `light` count what is scattered by more than the cut
// forward peak; those of `transport` are similarity scaled, 1 - omega g (delta-Eddington: Joseph,
// Wiscombe and Weinman 1976). Between cells' centres extinction is linear, so that a link's optical
// depth is the mean of its ends', times its length.
#pragma once

#include <cstdint>
#include <vector>

#include "glm/vec3.hpp"

namespace thunderhead::renderers {

// Cells, x fastest.
struct DiffusionCells {
  glm::ivec3 size{0};
  glm::dvec3 cell_m{0.0};
  std::vector<float> light_per_m;
  std::vector<float> transport_per_m;
  std::vector<float> absorption_per_m;
};

class DiffuseLight {
 public:
  explicit DiffuseLight(DiffusionCells cells);

  // What follows from the cells alone, for each of them.
  // The root of the optical depth of `light` to the nearest way out.
  const std::vector<float>& ExitRoot() const { return exit_root_; }
  // How much of what is seen from the nearest ways out is sky, not ground; and the net flux of an
  // even sky's light above a black ground into the cloud, over the flux from above.
  const std::vector<float>& SkySeen() const { return sky_seen_; }
  const std::vector<float>& SkyInward() const { return sky_inward_; }

  // For sunlight of irradiance 1 that arrives in each cell with the root of its optical depth
  // `arrived_root`: the net flux into the cloud that fluence (shaders/physics/light_transport.glsl,
  // diffuse_fluence) is made of. Starts from the last solution.
  const std::vector<float>& SolveSun(const glm::dvec3& towards_sun,
                                     const std::vector<float>& arrived_root);

  int Unknowns() const { return static_cast<int>(cell_of_.size()); }
  int LastIterations() const { return last_iterations_; }

 private:
  static constexpr std::int32_t kNone = -1;
  // The six ways out of a cell: even numbers down, odd ones up an axis.
  struct Links {
    std::int32_t to[6];
    float conductance[6];
    // What resists diffuse light besides three times the optical depth: at a way out twice the
    // reciprocal of the face's cosine to the surface (Marshak's condition), else the limit of a
    // hop.
    float slack[6];
  };

  std::size_t Offset(const glm::ivec3& cell) const;
  void Number();
  void FindExits();
  void ScanExits(int axis, std::vector<float>* sum, std::vector<float>* all);
  float TransportExit(std::size_t cell) const;
  void MakeLinks();
  void Factor();
  void SolveSky();
  void Precondition(const std::vector<float>& from, std::vector<float>* to) const;
  void Apply(const std::vector<float>& from, std::vector<float>* to) const;
  void Solve(const std::vector<float>& right, double tolerance, std::vector<float>* solution);
  // Gives empty cells beside others the mean of those.
  void Spread(std::vector<float>* values) const;

  DiffusionCells cells_;
  std::vector<std::int32_t> number_;   // by cell; kNone where there is nothing
  std::vector<std::int32_t> cell_of_;  // by number
  std::vector<Links> links_;           // by number
  std::vector<float> diagonal_;        // by number
  std::vector<float> inverse_pivot_;   // of the incomplete Cholesky factor
  std::vector<float> exit_root_;
  std::vector<float> sky_seen_;
  std::vector<float> sky_inward_;
  std::vector<float> fluence_;  // by number
  std::vector<float> net_inward_;
  std::vector<float> residual_, direction_, image_, better_;
  float area_[3] = {};  // of a cell's faces, over that across z
  int last_iterations_ = 0;
};

}  // namespace thunderhead::renderers
