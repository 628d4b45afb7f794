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
struct ModelWind {
  glm::ivec3 cells{0};
  double dx_m = 0.0;
  double dy_m = 0.0;
  // True if the wind is on the cells' faces. Then u has one value more along x (on the western and
  // eastern faces), and v one more along y (southern and northern). W has one more along z (lower
  // and upper). Otherwise all values are at the cells' centres.
  bool on_faces = true;
  // True if u is the wind to the east and v to the north, false if they are along the x and y axes
  // of the model's columns.
  bool east_and_north = false;
  // False if cells that follow one another are not neighbours (those of an unstructured grid).
  bool in_order = true;
  std::vector<float> u_m_per_s;
  std::vector<float> v_m_per_s;
  std::vector<float> w_m_per_s;
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

Wind WindInCells(const ModelWind& wind, const std::vector<float>& interface_height_m);

// Returns the turbulent kinetic energy (m2/s2) of the subgrid eddies in each cell. The eddies are
// assumed to be in equilibrium with the deformation |D| of the resolved wind. The energy is (0.4 l
// |D|)^2, where l is the cube root of the cell's volume. This formula follows from Smagorinsky's
// eddy viscosity (0.2 l)^2 |D| and Deardorff's 0.1 l e^(1/2) (Smagorinsky 1963, Deardorff 1980).
// The energy is 0 where an input is missing.
std::vector<float> EnergyOfDeformation(const Wind& wind);

// Returns for each layer the mean of the values at its lower and upper interface. `at_interfaces`
// has `levels` + 1 values for each of `columns` columns.
std::vector<float> LayerMeans(const std::vector<float>& at_interfaces, int levels,
                              std::size_t columns);

// Returns the mean of the values of each level, leaving out missing values. The mean is NaN for a
// level whose values are all missing.
std::vector<double> LevelMeans(const std::vector<float>& values, int levels);

// Returns the mean wind of each level, from the components `u_m_per_s` and `v_m_per_s`. The mean is
// 0 for a level whose values are all missing.
std::vector<glm::dvec2> MeanWinds(const std::vector<float>& u_m_per_s,
                                  const std::vector<float>& v_m_per_s, int levels);

// Returns the mean of `winds`, weighted by the thickness of levels, in the lowest 6 km above the
// first interface. The winds are those of levels between `interface_height_m` (one more). Returns 0
// if the heights there are missing, or if the mean is implausibly strong (kMaxSteering_m_per_s).
glm::dvec2 SteeringWind_m_per_s(const std::vector<glm::dvec2>& winds,
                                const std::vector<double>& interface_height_m);

// Returns the wind at the mean height of the frozen hydrometeors, minus the wind at the mean height
// of cloud water. Both heights are weighted by mass. `winds` has one value for each level, and
// `interface_height_m` one height more. Returns 0 if the fields have no ice or no cloud water.
glm::dvec2 Shear_m_per_s(const volume::HydrometeorFields& fields,
                         const std::vector<glm::dvec2>& winds,
                         const std::vector<double>& interface_height_m);

}  // namespace thunderhead::storm_files
