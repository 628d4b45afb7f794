// Refractive indices of water and ice at the wavelengths that stand for red, green and blue.
#pragma once

#include "physics/phase_table.h"

namespace thunderhead::physics {

inline constexpr PhaseRgb kWavelengthsUm = {0.65, 0.55, 0.45};

// Returns the refractive index of liquid water at 10 degrees Celsius relative to air, at a
// wavelength from 0.2 to 1.1 um. Source: Harvey, Gallagher and Levelt Sengers 1998 (J. Phys. Chem.
// Ref. Data 27, 761; the IAPWS formulation), eq. 7.
double WaterRefractiveIndex(double wavelength_um);

// The imaginary part of water's refractive index at kWavelengthsUm: Hale and Querry 1973 (Appl.
// Opt. 12, 555), table I.
inline constexpr PhaseRgb kWaterAbsorption = {1.64e-8, 1.96e-9, 1.02e-9};

// The real refractive index of ice Ih at kWavelengthsUm: Warren 1984 and Warren and Brandt 2008 (J.
// Geophys. Res. 113, D14220). Absorption is neglected, because it removes less than 0.1 % of
// visible light over a path of 1 mm.
inline constexpr PhaseRgb kIceRefractiveIndex = {1.3078, 1.3110, 1.3157};

}  // namespace thunderhead::physics
