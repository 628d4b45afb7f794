// Light scattered many times, from the diffusion (P1) equation on the medium's cells. There is one
// linear system for each sun and one for the sky. The code works with plain values on the CPU and
// does not use GL or scenes.
//
// There are two kinds of optical depths. Those of `light` count light that is scattered by more
// than the cut forward peak. Those of `transport` are similarity scaled by 1 - omega g
// (delta-Eddington: Joseph, Wiscombe and Weinman 1976). Extinction is linear between cell centres,
// so a link's optical depth is the mean extinction of its ends times its length.
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

  // Results of each cell that follow from the cells alone. ExitRoot returns the square root of the
  // optical depth of `light` to the nearest exit.
  const std::vector<float>& ExitRoot() const { return exit_root_; }
  // SkySeen returns the share of the light entering by the nearest exits that is skylight above a
  // black ground, direct or from other walls. SkyInward returns its net flux into the cloud. The
  // sky's radiance is approximated as linear in the sine of the elevation. The value x weighs its
  // irradiance from above over pi, and y its mean radiance. The sum x + y is the weight of a
  // uniform sky.
  const std::vector<glm::vec2>& SkySeen() const { return sky_seen_; }
  const std::vector<glm::vec2>& SkyInward() const { return sky_inward_; }

  // Solves for sunlight of irradiance 1 that arrives in each cell with `arrived_root`, the root of
  // its optical depth. Returns the net flux into the cloud, from which diffuse_fluence computes the
  // fluence (shaders/physics/light_transport.glsl). The iteration starts from the last solution. If
  // the sun keeps moving as before, it extrapolates the last change. It ends when the residual, in
  // the preconditioner's norm, is less than `tolerance` times the right side.
  const std::vector<float>& SolveSun(const glm::dvec3& towards_sun,
                                     const std::vector<float>& arrived_root,
                                     double tolerance = 2e-4);
  // Returns the fluence that other walls send in, for the last SolveSun.
  const std::vector<float>& FromWalls() const { return from_walls_; }

  // Returns the cells with values for a sun and from AtCells. In all other cells the values are 0.
  const std::vector<NumberedCells::Valued>& CellsWithValues() const {
    return numbered_.WithValues();
  }

  // Returns `value` at each non-empty cell. Empty cells next to them have the mean of these, others
  // 0. The result is valid until the next sun or call.
  //
  // Cells outside `parts` keep their values from the last call, so the first call must include all
  // parts. All threads call `value`. Its arguments are the place of the cell's centre, relative to
  // the low corner of the cells, and the direction out. Along each axis, that direction is the mean
  // of 1 up and -1 down, weighted by how near either exit is.
  using CellValue = std::function<float(const glm::dvec3& place_m, const glm::vec3& outward)>;
  const std::vector<float>& AtCells(const CellValue& value,
                                    SunParts::Parts parts = SunParts::Parts().set());

  int LastIterations() const { return last_iterations_; }

 private:
  struct Optics {
    float light_per_m;
    float absorption_per_m;
    float exit;            // optical depth of `light` to the nearest exit
    float transport_exit;  // optical depth of `transport` on the same path
  };

  // Sunlight in a cell, by number, for the sun being solved.
  struct SunAt {
    float depth = 0.0F;          // optical depth of the arriving sunlight
    float transmittance = 1.0F;  // exp(-depth)
    // Mean transmittance on the path to the next cell up each axis.
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

  DiffusionCells cells_;  // their extinction is freed after the sky is solved
  WallLight walls_;
  NumberedCells numbered_;
  LinkedCells linked_;
  std::vector<Optics> optics_;  // by number
  // Resistance to diffuse light, by number and side, in addition to three times the optical depth.
  // At a surface it is twice the reciprocal of the face's cosine to it (Marshak's condition).
  // Elsewhere it limits a horizontal step.
  std::vector<std::array<float, 6>> slack_;
  std::vector<float> exit_root_;
  std::vector<glm::vec3> outward_;  // for AtCells, by number
  std::vector<glm::vec2> sky_seen_;
  std::vector<glm::vec2> sky_inward_;
  std::vector<float> from_walls_;
  std::vector<SunAt> sun_;
  std::vector<float> fluence_;         // by number
  std::vector<float> fluence_before_;  // for the previous sun
  glm::dvec3 last_sun_{0.0};
  glm::dvec3 last_step_{0.0};  // from the previous sun to last_sun_
  std::vector<float> net_inward_;
  std::vector<float> values_;  // for AtCells, by number
  // For AtCells; while a sun is being solved, the light that cells send out.
  std::vector<float> at_cells_;
  float area_[3] = {};  // area of a cell's faces relative to that across z
  int last_iterations_ = 0;
};

}  // namespace thunderhead::renderers
