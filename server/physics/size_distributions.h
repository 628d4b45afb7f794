// The size distributions that microphysics schemes assume: what a model that neither counts nor
// measures its particles nevertheless means by their mass. Knows no files.
#pragma once

#include <string_view>

#include "physics/hydrometeors.h"

namespace thunderhead::physics {

enum class Microphysics { kUnknown, kWsm6, kWsm6WithHail, kThompson };

// "WSM6", "WSM6 with hail", "Thompson"; "" if unknown.
std::string_view NameOf(Microphysics microphysics);

// True if the scheme's own distribution of these particles is known here.
bool HasDistribution(Microphysics microphysics, Hydrometeor hydrometeor);

// The effective radius (m) of the particles in air that holds `content_kg_per_m3` of them (above
// zero) at `temperature_K`, which only snow depends on. Where the scheme's particles are of another
// density than DefaultOptics says, it is the radius of particles of that density with the same
// extinction by mass. Within kMinRadius_m and kMaxRadius_m.
//
// WSM6: Hong and Lim 2006, with the limits of WRF's mp_wsm6_effectRad; with hail (WRF's HAIL_OPT)
// its graupel has the intercept and density of hail. Snow: spheres of 100 kg/m3, from whose mass
// the scheme finds its slope. Their extinction by mass at 1 mm, 30 m2/kg, is that of observed
// aggregates (Mitchell 1996: 27). What WRF hands to the radiation instead, 0.5 / slope, is a third
// of that radius; it is meant for optics by the density of solid ice.
//
// Thompson (Thompson et al. 2008): cloud droplets as in calc_effectRad of WRF 4.7, graupel by that
// version's intercept. Its rain and ice are counted. Its snow has a mass for each diameter and
// moments (Field et al. 2005), but no area, on which extinction depends.
float DistributionRadius_m(Microphysics microphysics, Hydrometeor hydrometeor,
                           float content_kg_per_m3, float temperature_K);

}  // namespace thunderhead::physics
