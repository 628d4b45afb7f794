// Light scattered many times, from the diffusion (P1) equation on the medium's cells: one linear
// system for each sun, one for the sky. Plain values on the CPU; knows no GL and no scene.
//
// Optical depths are of two kinds. Those of `light` count what is scattered by more than the cut
// forward peak; those of `transport` are similarity scaled, 1 - omega g (delta-Eddington: Joseph,
// Wiscombe and Weinman 1976). Between cells' centres extinction is linear, so that a link's optical
// depth is the mean of its ends', times its length.
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

  // Results that follow from the cells alone, for each of them.
  // The square root of the optical depth of `light` to the nearest exit.
  const std::vector<float>& ExitRoot() const { return exit_root_; }
  // The share of the light entering by the nearest exits that is skylight above a black ground,
  // direct or from other walls, and its net flux into the cloud. The sky's radiance is approximated
  // as linear in the sine of the elevation: x weighs its irradiance from above over pi, y its mean
  // radiance; x + y is the weight of a uniform sky.
  const std::vector<glm::vec2>& SkySeen() const { return sky_seen_; }
  const std::vector<glm::vec2>& SkyInward() const { return sky_inward_; }

  // For sunlight of irradiance 1 that arrives in each cell with the root of its optical depth
  // `arrived_root`: the net flux into the cloud, from which diffuse_fluence computes the fluence
  // (shaders/physics/light_transport.glsl). Starts from the last solution, for a sun that goes on
  // as it did before from how that changed, and ends where the residual, in the preconditioner's
  // norm, is less than `tolerance` times the right side.
  const std::vector<float>& SolveSun(const glm::dvec3& towards_sun,
                                     const std::vector<float>& arrived_root,
                                     double tolerance = 2e-4);
  // The fluence that other walls send in, of the last SolveSun.
  const std::vector<float>& FromWalls() const { return from_walls_; }

  // The cells that have values of a sun and of AtCells; in all others they are 0.
  const std::vector<NumberedCells::Valued>& CellsWithValues() const {
    return numbered_.WithValues();
  }

  // A value of each cell that holds anything, and for empty ones beside them the mean of those; 0
  // elsewhere; until the next sun or call. Of parts that are not in `parts` they stay those of the
  // last call; the first must have all. `value` is called on all threads with the place of the
  // cell's centre from the cells' low corner, and the direction out: along each axis the mean of 1
  // up and -1 down, weighted by how near either exit is.
  using CellValue = std::function<float(const glm::dvec3& place_m, const glm::vec3& outward)>;
  const std::vector<float>& AtCells(const CellValue& value,
                                    SunParts::Parts parts = SunParts::Parts().set());

  int LastIterations() const { return last_iterations_; }

 private:
  struct Optics {
    float light_per_m;
    float absorption_per_m;
    float exit;            // optical depth of `light` to the nearest exit
    float transport_exit;  // the same path's of `transport`
  };

  // Sunlight in a cell, by number, of the sun that is being solved for.
  struct SunAt {
    float depth = 0.0F;          // optical, of sunlight that arrives
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
  // Makes of the last fluence the start for another sun.
  void BeginFluence(const glm::dvec3& towards_sun);

  DiffusionCells cells_;  // their extinction until the sky is solved for
  WallLight walls_;
  NumberedCells numbered_;
  LinkedCells linked_;
  std::vector<Optics> optics_;  // by number
  // By number and side. Resistance to diffuse light besides three times the optical depth: at a
  // surface twice the reciprocal of the face's cosine to it (Marshak's condition), else the limit
  // of a hop.
  std::vector<std::array<float, 6>> slack_;
  std::vector<float> exit_root_;
  std::vector<glm::vec3> outward_;  // of AtCells, by number
  std::vector<glm::vec2> sky_seen_;
  std::vector<glm::vec2> sky_inward_;
  std::vector<float> from_walls_;
  std::vector<SunAt> sun_;
  std::vector<float> fluence_;         // by number
  std::vector<float> fluence_before_;  // that of the sun before
  glm::dvec3 last_sun_{0.0};
  glm::dvec3 last_step_{0.0};  // from the sun before to that
  std::vector<float> net_inward_;
  std::vector<float> values_;    // of AtCells, by number
  std::vector<float> at_cells_;  // of AtCells; while a sun is solved for, what cells send out
  float area_[3] = {};           // of a cell's faces, over that across z
  int last_iterations_ = 0;
};

}  // namespace thunderhead::renderers
