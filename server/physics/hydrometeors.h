// The kinds of hydrometeors and the optics of one particle of each: radius, bulk density, albedo,
// phase function, false colour. Knows no files and no GL.
//
// Radii: observed. Cloud droplets 10 um, ice crystals 30 um; the others are effective radii of the
// exponential distributions that were observed, at 1 g/m3: rain by Marshall and Palmer 1948, snow
// by Houze et al. 1979 at -20 C, graupel as in Rutledge and Hobbs 1984, hail by Federer and
// Waldvogel 1975. The papers' radii and false colours: Riley et al. 2003 (AMS), Tables II and III;
// densities as in common bulk microphysics.
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

// "cloud", "rain", "ice", "snow", "graupel" or "hail".
std::string_view NameOf(Hydrometeor hydrometeor);

// Formulas, then tables (docs/phase_tables.md); in the order of the message's enumerators.
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

struct PhaseFunction {
  PhaseKind kind = PhaseKind::kHenyeyGreenstein;
  float asymmetry = 0.0F;  // the parameter g of Henyey and Greenstein, and of Cornette and Shanks
  float droplet_radius_m = 0.0F;  // effective; chooses among the tables of water

  bool operator==(const PhaseFunction&) const = default;
};

// Optics of the particles of a field, as if all were alike.
struct ParticleOptics {
  float radius_m;
  float density_kg_per_m3;
  float albedo;
  PhaseFunction phase;    // droplet_radius_m is not set; PhaseOf (optics.h) sets it from radius_m
  glm::vec3 false_color;  // linear sRGB
};

// The defaults of each hydrometeor.
const ParticleOptics& DefaultOptics(Hydrometeor hydrometeor);

// Riley et al. 2003 (AMS), Table II; hail, which it leaves out, 1 cm.
float PapersRadius_m(Hydrometeor hydrometeor);

// Mass extinction coefficient in m2/kg: extinction (1/m) per mass of condensate in a volume of air
// (kg/m3), 3 / (2 rho_f R_f). Riley et al. 2003 (AMS), eq. 4, geometric optics with an extinction
// efficiency of 2. `density_kg_per_m3` and `radius_m` must be above zero.
float MassExtinction_m2_per_kg(float density_kg_per_m3, float radius_m);

}  // namespace thunderhead::physics
