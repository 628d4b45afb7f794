#include "physics/hydrometeors.h"

#include <algorithm>

namespace thunderhead::physics {
namespace {

struct HydrometeorRow {
  Hydrometeor hydrometeor;
  std::string_view name;
  float papers_radius_m;
  ParticleOptics optics;
};

// The asymmetry parameters are for the formulas, should one be chosen: water 0.85 (Mie, r_e 10 um,
// 0.55 um, rounded down for the broad part of the lobe), smooth ice crystals 0.78, roughened and
// rimed ice 0.76.
constexpr std::array kRows = {
    HydrometeorRow{Hydrometeor::kCloud,
                   "cloud",
                   1e-5F,
                   {1e-5F, 1000.0F, 1.0F, {PhaseKind::kWaterDroplets, 0.85F}, {1.0F, 0.0F, 0.0F}}},
    HydrometeorRow{
        Hydrometeor::kRain,
        "rain",
        1e-3F,
        {6.7e-4F, 1000.0F, 1.0F, {PhaseKind::kWaterDroplets, 0.85F}, {0.0F, 0.0F, 1.0F}}},
    HydrometeorRow{Hydrometeor::kIce,
                   "ice",
                   1e-3F,
                   {3e-5F, 917.0F, 1.0F, {PhaseKind::kIceColumns, 0.78F}, {1.0F, 0.0F, 1.0F}}},
    HydrometeorRow{Hydrometeor::kSnow,
                   "snow",
                   2e-3F,
                   {9.2e-4F, 100.0F, 1.0F, {PhaseKind::kIceRough, 0.76F}, {1.0F, 1.0F, 0.0F}}},
    HydrometeorRow{Hydrometeor::kGraupel,
                   "graupel",
                   2.5e-3F,
                   {9.5e-4F, 500.0F, 1.0F, {PhaseKind::kIceRough, 0.76F}, {0.0F, 1.0F, 0.0F}}},
    HydrometeorRow{Hydrometeor::kHail,
                   "hail",
                   1e-2F,
                   {2.6e-3F, 900.0F, 1.0F, {PhaseKind::kIceRough, 0.76F}, {0.0F, 1.0F, 1.0F}}},
};
static_assert(std::ranges::equal(kRows, kHydrometeors, {}, &HydrometeorRow::hydrometeor));

const HydrometeorRow& RowOf(Hydrometeor hydrometeor) { return kRows[IndexOf(hydrometeor)]; }

}  // namespace

std::string_view NameOf(Hydrometeor hydrometeor) { return RowOf(hydrometeor).name; }

const ParticleOptics& DefaultOptics(Hydrometeor hydrometeor) { return RowOf(hydrometeor).optics; }

float PapersRadius_m(Hydrometeor hydrometeor) { return RowOf(hydrometeor).papers_radius_m; }

float MassExtinction_m2_per_kg(float density_kg_per_m3, float radius_m) {
  return 3.0F / (2.0F * density_kg_per_m3 * radius_m);
}

}  // namespace thunderhead::physics
