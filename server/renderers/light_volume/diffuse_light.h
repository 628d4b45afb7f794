// Light scattered many times, from the diffusion (P1) equation on the medium's cells. There is one
// linear system for each sun and one for the sky. The code works with plain values on the CPU and
// does not use GL or scenes.
//
// There are two kinds of optical depths. Those of `light_per_m` exclude the forward peak that delta
// scaling cuts off. Those of `transport_per_m` are similarity scaled by 1 - omega g
// (delta-Eddington: Joseph, Wiscombe and Weinman 1976). Extinction is linear between cell centres.
// The optical depth between two linked cells is therefore the mean of their extinctions times the
// distance.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "renderers/light_volume/diffusion_cells.h"
#include "renderers/light_volume/linked_cells.h"
#include "renderers/light_volume/numbered_cells.h"
#include "renderers/light_volume/sun_parts.h"
#include "renderers/light_volume/wall_light.h"

namespace thunderhead::renderers {

class DiffuseLight {
 public:
  explicit DiffuseLight(DiffusionCells cells);

  // The following functions return one value per cell. The values do not depend on the sun.
  // ExitRoot returns the square root of the optical depth from each cell to the nearest surface of
  // the medium (its exit), computed from `light_per_m`.
  const std::vector<float>& ExitRoot() const { return exit_root_; }
  // SkySeen returns the skylight that arrives at the exits around each cell, where nearer exits
  // have more weight. Other walls (wall_light.h) hide a part of the sky, but also send skylight.
  // The ground counts as black. SkyInward returns the net flux of skylight into the cloud.
  //
  // The sky's radiance is approximated as linear in the sine of the elevation. Component x is the
  // weight of the sky's irradiance from above divided by pi, and y is the weight of its mean
  // radiance. A uniform sky has the weight x + y.
  const std::vector<glm::vec2>& SkySeen() const { return sky_seen_; }
  const std::vector<glm::vec2>& SkyInward() const { return sky_inward_; }

  // Solves for sunlight of irradiance 1. `arrived_root` is the square root of the optical depth
  // that sunlight passes to each cell. Returns the net flux into the cloud, from which
  // diffuse_fluence (shaders/physics/light_transport.glsl) computes the fluence. The iteration
  // starts from the last solution. If the sun keeps moving as before, it extrapolates the last
  // change. The iteration ends when the residual, in the preconditioner's norm, is less than
  // `tolerance` times the right side.
  const std::vector<float>& SolveSun(const glm::dvec3& towards_sun,
                                     const std::vector<float>& arrived_root,
                                     double tolerance = 2e-4);
  // Returns the fluence that other walls send into each cell, for the last SolveSun.
  const std::vector<float>& FromWalls() const { return from_walls_; }

  // Returns the cells that have values from SolveSun and AtCells. In all other cells the values are
  // 0.
  const std::vector<NumberedCells::Valued>& CellsWithValues() const {
    return numbered_.WithValues();
  }

  // Evaluates `value` at each non-empty cell. An empty cell next to non-empty cells gets the mean
  // of their values, every other empty cell 0. The result is valid until the next call of AtCells
  // or SolveSun.
  //
  // Cells outside `parts` keep their values from the last call, so the first call must include all
  // parts. Several threads call `value`. Its first argument is the cell's centre relative to the
  // low corner of the cells. Its second argument is the mean direction out of the cloud. Along each
  // axis this direction is the mean of +1 and -1, weighted by how near the exit on that side is.
  using CellValue = std::function<float(const glm::dvec3& place_m, const glm::vec3& outward)>;
  const std::vector<float>& AtCells(const CellValue& value,
                                    SunParts::Parts parts = SunParts::Parts().set());

  int LastIterations() const { return last_iterations_; }

 private:
  struct Optics {
    float light_per_m;
    float absorption_per_m;
    float exit;            // optical depth by `light_per_m` to the nearest exit
    float transport_exit;  // optical depth by `transport_per_m` on the same path
  };

  // Sunlight in a cell for the sun that is being solved. Cells are indexed by number
  // (NumberedCells).
  struct SunAt {
    float depth = 0.0F;          // optical depth of the arriving sunlight
    float transmittance = 1.0F;  // exp(-depth)
    // Mean transmittance on the path to the next cell in the positive direction of each axis.
    float mean_transmittance_up[3] = {};
  };

  void FindTransmittances(const std::vector<float>& arrived_root);
  float SunlightScattered(std::size_t n, const glm::dvec3& towards_sun) const;
  void FindExits();
  void ScanExits(int axis, std::vector<float>* sum, std::vector<float>* all,
                 std::vector<glm::vec3>* outward);
  void Link();
  void SolveSky();
  void SolveSkyPart(int part);
  // Prepares the last fluence as the initial value for another sun.
  void BeginFluence(const glm::dvec3& towards_sun);

  DiffusionCells cells_;  // the cells; their extinction is freed after the sky is solved
  WallLight walls_;
  NumberedCells numbered_;
  LinkedCells linked_;
  std::vector<Optics> optics_;  // optics of each numbered cell
  // Resistance to diffuse light, by number and side, in addition to three times the optical depth.
  // At a surface the resistance is 2 / c, where c is the cosine of the angle between the cell's
  // face and the cloud's surface (Marshak's condition). Elsewhere it limits the horizontal distance
  // that light travels (kFarthestHop).
  std::vector<std::array<float, 6>> slack_;
  std::vector<float> exit_root_;
  std::vector<glm::vec3> outward_;  // outward directions for AtCells, by number
  std::vector<glm::vec2> sky_seen_;
  std::vector<glm::vec2> sky_inward_;
  std::vector<float> from_walls_;
  std::vector<SunAt> sun_;
  std::vector<float> fluence_;         // fluence of each numbered cell
  std::vector<float> fluence_before_;  // fluence for the previous sun
  glm::dvec3 last_sun_{0.0};
  glm::dvec3 last_step_{0.0};  // step from the previous sun to last_sun_
  std::vector<float> net_inward_;
  std::vector<float> values_;  // values for AtCells, by number
  // Values for AtCells. While SolveSun runs, the buffer holds the light that cells send out.
  std::vector<float> at_cells_;
  float area_[3] = {};  // area of a cell's face across each axis, relative to the face across z
  int last_iterations_ = 0;
};

}  // namespace thunderhead::renderers
