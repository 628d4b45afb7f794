// The kinds of hydrometeors and the optics of one particle of each: radius, bulk density, albedo,
// phase function and false colour. This code does not use files or GL.
//
// The default radii are observed radii. Cloud droplets have 10 um and ice crystals 30 um. The other
// kinds have the effective radius of an observed exponential size distribution at 1 g/m3. The
// sources for rain and snow are Marshall and Palmer 1948, and Houze et al. 1979 at -20 C. The
// sources for graupel and hail are Rutledge and Hobbs 1984, and Federer and Waldvogel 1975. The
// papers' radii are from Riley et al. 2003 (AMS), Table II. Densities are those of common bulk
// microphysics.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "glm/vec3.hpp"

namespace thunderhead::physics {

enum class Hydrometeor { kCloud, kRain, kIce, kSnow, kGraupel, kHail };

inline constexpr std::array kHydrometeors = {Hydrometeor::kCloud,   Hydrometeor::kRain,
                                             Hydrometeor::kIce,     Hydrometeor::kSnow,
                                             Hydrometeor::kGraupel, Hydrometeor::kHail};
inline constexpr std::size_t kHydrometeorCount = kHydrometeors.size();

constexpr std::size_t IndexOf(Hydrometeor hydrometeor) {
  return static_cast<std::size_t>(hydrometeor);
}

// Returns "cloud", "rain", "ice", "snow", "graupel" or "hail".
std::string_view NameOf(Hydrometeor hydrometeor);

// A kind of phase function: a formula (kPhaseFormulas in optics.cc) or a table (kPhaseTables).
enum class PhaseKind {
  kHenyeyGreenstein,
  kCornetteShanks,
  kRayleigh,
  kWaterDroplets,
  kIceColumns,
  kIcePlates,
  kIceRough,
  kWaterNarrow
};

// The names of the kinds. A name is that of the enumerator in the message PhaseFunction.Kind, in
// lower case and without KIND_. Messages are converted by name, so the kinds may be in any order.
struct PhaseKindName {
  PhaseKind kind;
  std::string_view name;
};
inline constexpr std::array kPhaseKindNames = {
    PhaseKindName{PhaseKind::kHenyeyGreenstein, "henyey_greenstein"},
    PhaseKindName{PhaseKind::kCornetteShanks, "cornette_shanks"},
    PhaseKindName{PhaseKind::kRayleigh, "rayleigh"},
    PhaseKindName{PhaseKind::kWaterDroplets, "water_droplets"},
    PhaseKindName{PhaseKind::kIceColumns, "ice_columns"},
    PhaseKindName{PhaseKind::kIcePlates, "ice_plates"},
    PhaseKindName{PhaseKind::kIceRough, "ice_rough"},
    PhaseKindName{PhaseKind::kWaterNarrow, "water_narrow"},
};

// The computed tables (docs/phase_tables.md) of the kinds that are not formulas. Water droplets
// have tables for several radii, of which the nearest radius is chosen. For the other kinds,
// `droplet_radius_m` is 0 and unused.
struct PhaseTableName {
  PhaseKind kind;
  float droplet_radius_m;
  const char* name;  // name of the recipe (tables/recipes.h) and of the file in data/phase
};
inline constexpr std::array kPhaseTables = {
    PhaseTableName{PhaseKind::kWaterDroplets, 5e-6F, "cloud_re05"},
    PhaseTableName{PhaseKind::kWaterDroplets, 1e-5F, "cloud_re10"},
    PhaseTableName{PhaseKind::kWaterDroplets, 2e-5F, "cloud_re20"},
    PhaseTableName{PhaseKind::kWaterDroplets, 5e-4F, "rain"},
    PhaseTableName{PhaseKind::kIceColumns, 0.0F, "ice_columns"},
    PhaseTableName{PhaseKind::kIcePlates, 0.0F, "ice_plates"},
    PhaseTableName{PhaseKind::kIceRough, 0.0F, "ice_rough"},
    PhaseTableName{PhaseKind::kWaterNarrow, 0.0F, "cloud_re05_narrow"},
};

struct PhaseFunction {
  PhaseKind kind = PhaseKind::kHenyeyGreenstein;
  float asymmetry = 0.0F;  // the parameter g of Henyey and Greenstein, and of Cornette and Shanks
  float droplet_radius_m = 0.0F;  // effective radius; selects one of the tables of water

  bool operator==(const PhaseFunction&) const = default;
};

// Optics of the particles of a field. All particles of a field have the same optics.
struct ParticleOptics {
  float radius_m;
  float density_kg_per_m3;
  float albedo;
  PhaseFunction phase;    // droplet_radius_m is not set; PhaseOf (optics.h) sets it from radius_m
  glm::vec3 false_color;  // linear sRGB
};

// The properties of one kind of hydrometeor. The rows are in the order of Hydrometeor.
struct HydrometeorRow {
  Hydrometeor hydrometeor;
  std::string_view name;
  float papers_radius_m;
  ParticleOptics optics;
};

// The asymmetry parameters apply if a scene chooses a formula. Water has 0.85 (Mie theory for an
// effective radius of 10 um at 0.55 um, rounded down). It is rounded down because a formula
// represents only the broad part of the forward lobe. Smooth ice crystals have 0.78, roughened and
// rimed ice 0.76. The false colours are Okabe and Ito's (#E69F00, #56B4E9, #CC79A7, #F0E442,
// #009E73, #D55E00). People with any colour vision can tell them apart.
inline constexpr std::array kHydrometeorRows = {
    HydrometeorRow{
        Hydrometeor::kCloud,
        "cloud",
        1e-5F,
        {1e-5F, 1000.0F, 1.0F, {PhaseKind::kWaterDroplets, 0.85F}, {0.7913F, 0.3467F, 0.0F}}},
    HydrometeorRow{
        Hydrometeor::kRain,
        "rain",
        1e-3F,
        {6.7e-4F, 1000.0F, 1.0F, {PhaseKind::kWaterDroplets, 0.85F}, {0.09306F, 0.4564F, 0.8148F}}},
    HydrometeorRow{
        Hydrometeor::kIce,
        "ice",
        1e-3F,
        {3e-5F, 917.0F, 1.0F, {PhaseKind::kIceColumns, 0.78F}, {0.6038F, 0.1912F, 0.3864F}}},
    HydrometeorRow{
        Hydrometeor::kSnow,
        "snow",
        2e-3F,
        {9.2e-4F, 100.0F, 1.0F, {PhaseKind::kIceRough, 0.76F}, {0.8714F, 0.7758F, 0.05448F}}},
    HydrometeorRow{
        Hydrometeor::kGraupel,
        "graupel",
        2.5e-3F,
        {9.5e-4F, 500.0F, 1.0F, {PhaseKind::kIceRough, 0.76F}, {0.0F, 0.3419F, 0.1714F}}},
    HydrometeorRow{
        Hydrometeor::kHail,
        "hail",
        1e-2F,
        {2.6e-3F, 900.0F, 1.0F, {PhaseKind::kIceRough, 0.76F}, {0.6654F, 0.1119F, 0.0F}}},
};

// Returns the default optics of a hydrometeor.
const ParticleOptics& DefaultOptics(Hydrometeor hydrometeor);

// Returns the radius of Riley et al. 2003 (AMS), Table II. The table omits hail, for which the
// function returns 1 cm.
float PapersRadius_m(Hydrometeor hydrometeor);

// Returns the mass extinction coefficient in m2/kg, which is 3 / (2 rho_f R_f). It is the
// extinction (1/m) per mass of condensate in a volume of air (kg/m3). The source is Riley et al.
// 2003 (AMS), eq. 4: geometric optics with an extinction efficiency of 2. `density_kg_per_m3` and
// `radius_m` must be above zero.
float MassExtinction_m2_per_kg(float density_kg_per_m3, float radius_m);

}  // namespace thunderhead::physics
