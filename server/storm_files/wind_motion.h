// Turbulence, ascent, shear and the steering wind from the winds that a file has, at the middles of
// cells or, as WRF has them, on their faces (Arakawa C). Pure arithmetic; knows no files.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

// All arrays have x running fastest, then y, then levels upwards; missing values are NaN.
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
  // At cells' middles.
  std::vector<float> u_m_per_s;
  std::vector<float> v_m_per_s;
  std::vector<float> w_m_per_s;
  std::vector<float> height_m;
};

Wind WindInCells(const StaggeredWind& wind, const std::vector<float>& interface_height_m);

// Turbulent kinetic energy (m2/s2) of each cell that subgrid eddies have in equilibrium with the
// deformation |D| of the resolved wind: (0.4 l |D|)^2, l being the cube root of the cell's volume,
// by Smagorinsky's eddy viscosity (0.2 l)^2 |D| and Deardorff's 0.1 l e^(1/2) (Smagorinsky 1963,
// Deardorff 1980). 0 where an input is missing.
std::vector<float> EnergyOfDeformation(const Wind& wind);

// Means of values on `levels` + 1 interfaces of `columns` columns, below and above each layer.
std::vector<float> LayerMeans(const std::vector<float>& at_interfaces, int levels,
                              std::size_t columns);

// Means of the values of each of `levels` levels, missing ones left out; NaN where all are missing.
std::vector<double> LevelMeans(const std::vector<float>& values, int levels);

// The mean wind over all of `u_m_per_s` and `v_m_per_s` at each level; 0 where all are missing.
std::vector<glm::dvec2> MeanWinds(const std::vector<float>& u_m_per_s,
                                  const std::vector<float>& v_m_per_s, int levels);

// The mean by height of `winds` of levels between `interface_height_m` (one more) in the lowest
// 6 km above the first; 0 if the heights there are missing, or if it is
// implausibly strong (kMaxSteering_m_per_s).
glm::dvec2 SteeringWind_m_per_s(const std::vector<glm::dvec2>& winds,
                                const std::vector<double>& interface_height_m);

// The wind at the mean height of the fields' ice less that at their cloud water's, by `winds` of
// levels between `interface_height_m`; 0 if there is not both.
glm::dvec2 Shear_m_per_s(const volume::HydrometeorFields& fields,
                         const std::vector<glm::dvec2>& winds,
                         const std::vector<double>& interface_height_m);

}  // namespace thunderhead::storm_files
