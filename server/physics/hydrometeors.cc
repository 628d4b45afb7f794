#include "physics/hydrometeors.h"

#include <algorithm>

namespace thunderhead::physics {
namespace {

static_assert(std::ranges::equal(kHydrometeorRows, kHydrometeors, {},
                                 &HydrometeorRow::hydrometeor));

const HydrometeorRow& RowOf(Hydrometeor hydrometeor) {
  return kHydrometeorRows[IndexOf(hydrometeor)];
}

}  // namespace

std::string_view NameOf(Hydrometeor hydrometeor) { return RowOf(hydrometeor).name; }

const ParticleOptics& DefaultOptics(Hydrometeor hydrometeor) { return RowOf(hydrometeor).optics; }

float PapersRadius_m(Hydrometeor hydrometeor) { return RowOf(hydrometeor).papers_radius_m; }

float MassExtinction_m2_per_kg(float density_kg_per_m3, float radius_m) {
  return 3.0F / (2.0F * density_kg_per_m3 * radius_m);
}

}  // namespace thunderhead::physics
