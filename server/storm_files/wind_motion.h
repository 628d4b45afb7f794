// Computes turbulence, ascent, shear and the steering wind from a file's winds. The winds are at
// the centres of cells or, as in WRF, on their faces (Arakawa C). This code is pure arithmetic and
// does not depend on files.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

// In all arrays x runs fastest, then y, then levels upwards. Missing values are NaN.
struct StaggeredWind {
  glm::ivec3 cells{0};
  double dx_m = 0.0;
  double dy_m = 0.0;
  std::vector<float> u_m_per_s;  // (x + 1) * y * z values, on the cells' western and eastern faces
  std::vector<float> v_m_per_s;  // x * (y + 1) * z, on southern and northern ones
  std::vector<float> w_m_per_s;  // x * y * (z + 1), on lower and upper ones
};

struct Wind {
  glm::ivec3 cells{0};
  double dx_m = 0.0;
  double dy_m = 0.0;
  // Values at the cells' centres.
  std::vector<float> u_m_per_s;
  std::vector<float> v_m_per_s;
  std::vector<float> w_m_per_s;
  std::vector<float> height_m;
};

Wind WindInCells(const StaggeredWind& wind, const std::vector<float>& interface_height_m);

// Returns the turbulent kinetic energy (m2/s2) of each cell that subgrid eddies have in equilibrium
// with the deformation |D| of the resolved wind. It is (0.4 l |D|)^2, where l is the cube root of
// the cell's volume. It follows from Smagorinsky's eddy viscosity (0.2 l)^2 |D| and Deardorff's 0.1
// l e^(1/2) (Smagorinsky 1963, Deardorff 1980). It is 0 where an input is missing.
std::vector<float> EnergyOfDeformation(const Wind& wind);

// Returns the means of the interfaces below and above each layer, from `levels` + 1 interfaces of
// `columns` columns.
std::vector<float> LayerMeans(const std::vector<float>& at_interfaces, int levels,
                              std::size_t columns);

// Returns the mean of each of `levels` levels without missing values, or NaN where all are missing.
std::vector<double> LevelMeans(const std::vector<float>& values, int levels);

// Returns the mean wind over all of `u_m_per_s` and `v_m_per_s` at each level, or 0 where all are
// missing.
std::vector<glm::dvec2> MeanWinds(const std::vector<float>& u_m_per_s,
                                  const std::vector<float>& v_m_per_s, int levels);

// Returns the mean of `winds`, weighted by the thickness of levels, in the lowest 6 km above the
// first interface. The winds are those of levels between `interface_height_m` (one more). Returns 0
// if the heights there are missing, or if the mean is implausibly strong (kMaxSteering_m_per_s).
glm::dvec2 SteeringWind_m_per_s(const std::vector<glm::dvec2>& winds,
                                const std::vector<double>& interface_height_m);

// Returns the wind at the mean height of the fields' ice minus the wind at that of their cloud
// water. `winds` are those of levels between `interface_height_m`. Returns 0 unless there are both.
glm::dvec2 Shear_m_per_s(const volume::HydrometeorFields& fields,
                         const std::vector<glm::dvec2>& winds,
                         const std::vector<double>& interface_height_m);

}  // namespace thunderhead::storm_files
