#include "physics/hydrometeors.h"

namespace thunderhead::physics {
namespace {

constexpr std::array<std::string_view, kHydrometeorCount> kNames = {"cloud", "rain",    "ice",
                                                                    "snow",  "graupel", "hail"};

// The asymmetry parameters are for the formulas, should one be chosen: water 0.85 (Mie, r_e 10 um,
// 0.55 um, rounded down for the broad part of the lobe), smooth ice crystals 0.78, roughened and
// rimed ice 0.76.
const std::array<ParticleOptics, kHydrometeorCount> kDefaults = {{
    {1e-5F, 1000.0F, 1.0F, {PhaseKind::kWaterDroplets, 0.85F}, {1.0F, 0.0F, 0.0F}},
    {6.7e-4F, 1000.0F, 1.0F, {PhaseKind::kWaterDroplets, 0.85F}, {0.0F, 0.0F, 1.0F}},
    {3e-5F, 917.0F, 1.0F, {PhaseKind::kIceColumns, 0.78F}, {1.0F, 0.0F, 1.0F}},
    {9.2e-4F, 100.0F, 1.0F, {PhaseKind::kIceRough, 0.76F}, {1.0F, 1.0F, 0.0F}},
    {9.5e-4F, 500.0F, 1.0F, {PhaseKind::kIceRough, 0.76F}, {0.0F, 1.0F, 0.0F}},
    {2.6e-3F, 900.0F, 1.0F, {PhaseKind::kIceRough, 0.76F}, {0.0F, 1.0F, 1.0F}},
}};

}  // namespace

std::string_view NameOf(Hydrometeor hydrometeor) { return kNames[IndexOf(hydrometeor)]; }

const ParticleOptics& DefaultOptics(Hydrometeor hydrometeor) {
  return kDefaults[IndexOf(hydrometeor)];
}

float MassExtinction_m2_per_kg(float density_kg_per_m3, float radius_m) {
  return 3.0F / (2.0F * density_kg_per_m3 * radius_m);
}

}  // namespace thunderhead::physics
