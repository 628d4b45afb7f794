#include "physics/size_distributions.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/status.h"
#include "physics/particle_size.h"

namespace thunderhead::physics {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kWater_kg_per_m3 = 1000.0;

// WRF's limits of the effective radius of cloud droplets.
constexpr double kMinDroplet_m = 2.51e-6;
constexpr double kLargestDroplet_m = 50e-6;

// Spheres of the same density whose number decreases exponentially with their diameter.
struct Exponential {
  double intercept_per_m4;
  double density_kg_per_m3;
  double largest_slope_per_m;
};

constexpr Exponential kWsm6Rain = {8e6, kWater_kg_per_m3, 8e4};
constexpr Exponential kWsm6Graupel = {4e6, 500.0, 6e4};
constexpr Exponential kWsm6Hail = {4e4, 700.0, 2e4};

// Returns the radius at which particles of the default density have the same mass extinction.
double AtDefaultDensity(Hydrometeor hydrometeor, double radius_m, double density_kg_per_m3) {
  return radius_m * density_kg_per_m3 / DefaultOptics(hydrometeor).density_kg_per_m3;
}

double RadiusOf(const Exponential& particles, Hydrometeor hydrometeor, double content_kg_per_m3) {
  const double slope_per_m = std::sqrt(std::sqrt(kPi * particles.density_kg_per_m3 *
                                                 particles.intercept_per_m4 / content_kg_per_m3));
  return AtDefaultDensity(hydrometeor, 1.5 / std::min(slope_per_m, particles.largest_slope_per_m),
                          particles.density_kg_per_m3);
}

double Wsm6Droplets_m(double content_kg_per_m3) {
  constexpr double kDroplets_per_m3 = 3e8;
  const double slope_per_m =
      std::cbrt(kPi * kWater_kg_per_m3 * kDroplets_per_m3 / content_kg_per_m3);
  return std::clamp(1.5 / slope_per_m, kMinDroplet_m, kLargestDroplet_m);
}

double Wsm6Crystals_m(double content_kg_per_m3) {
  const double root = std::sqrt(content_kg_per_m3);
  const double crystals_per_m3 = std::clamp(5.38e7 * root * std::sqrt(root), 1e3, 1e6);
  const double diameter_m = 11.9 * std::sqrt(content_kg_per_m3 / crystals_per_m3);
  return std::clamp(0.75 * 0.163 * diameter_m, 10e-6, 125e-6);
}

// Returns the distribution of snow. In colder air the particles are more numerous and smaller
// (Houze et al. 1979).
Exponential Wsm6Snow(double temperature_K) {
  constexpr double kFreezing_K = 273.16;
  const double intercept_per_m4 = 2e6 * std::exp(0.12 * (kFreezing_K - temperature_K));
  return {std::clamp(intercept_per_m4, 2e6, 1e11), 100.0, 1e5};
}

// Returns nothing for fields that WSM6 does not have, such as hail separate from graupel.
std::optional<double> Wsm6Radius_m(Hydrometeor hydrometeor, const Exponential& graupel,
                                   double content_kg_per_m3, double temperature_K) {
  switch (hydrometeor) {
    case Hydrometeor::kCloud:
      return Wsm6Droplets_m(content_kg_per_m3);
    case Hydrometeor::kRain:
      return RadiusOf(kWsm6Rain, hydrometeor, content_kg_per_m3);
    case Hydrometeor::kIce:
      return Wsm6Crystals_m(content_kg_per_m3);
    case Hydrometeor::kSnow:
      return RadiusOf(Wsm6Snow(temperature_K), hydrometeor, content_kg_per_m3);
    case Hydrometeor::kGraupel:
      return RadiusOf(graupel, hydrometeor, content_kg_per_m3);
    default:
      return std::nullopt;
  }
}

// Returns the effective radius of cloud droplets that have a gamma distribution and a number
// concentration of 1e8 per m3. In the scheme, the shape parameter follows from this concentration
// and is 12.
double ThompsonDroplets_m(double content_kg_per_m3) {
  constexpr double kDroplets_per_m3 = 1e8;
  constexpr double kShape = 12.0;
  constexpr double kGammaRatio = (kShape + 1.0) * (kShape + 2.0) * (kShape + 3.0);
  const double slope_per_m =
      std::cbrt(kPi / 6.0 * kWater_kg_per_m3 * kDroplets_per_m3 * kGammaRatio / content_kg_per_m3);
  return std::clamp(0.5 * (kShape + 3.0) / slope_per_m, kMinDroplet_m, kLargestDroplet_m);
}

// Returns the radius of graupel. The particles are larger for a larger content, because the
// intercept increases only with the 2/7th power of the content.
double ThompsonGraupel_m(double content_kg_per_m3) {
  const double exponent = 3.0 + 2.0 / 7.0 * (std::log10(std::max(content_kg_per_m3, 1e-9)) + 8.0);
  // The slope for which the median volume diameter is 50 um, its minimum.
  constexpr double kLargestSlope_per_m = 3.672 / 50e-6;
  const Exponential graupel = {std::pow(10.0, std::clamp(exponent, 2.0, 6.0)), 400.0,
                               kLargestSlope_per_m};
  return RadiusOf(graupel, Hydrometeor::kGraupel, content_kg_per_m3);
}

// Returns nothing for Thompson's other fields. Their distributions depend on more than the content.
std::optional<double> ThompsonRadius_m(Hydrometeor hydrometeor, double content_kg_per_m3) {
  if (hydrometeor == Hydrometeor::kCloud) return ThompsonDroplets_m(content_kg_per_m3);
  if (hydrometeor == Hydrometeor::kGraupel) return ThompsonGraupel_m(content_kg_per_m3);
  return std::nullopt;
}

std::optional<double> Radius_m(Microphysics microphysics, Hydrometeor hydrometeor,
                               double content_kg_per_m3, double temperature_K) {
  switch (microphysics) {
    case Microphysics::kWsm6:
      return Wsm6Radius_m(hydrometeor, kWsm6Graupel, content_kg_per_m3, temperature_K);
    case Microphysics::kWsm6WithHail:
      return Wsm6Radius_m(hydrometeor, kWsm6Hail, content_kg_per_m3, temperature_K);
    case Microphysics::kThompson:
      return ThompsonRadius_m(hydrometeor, content_kg_per_m3);
    case Microphysics::kUnknown:
      break;
  }
  return std::nullopt;
}

}  // namespace

std::string_view NameOf(Microphysics microphysics) {
  switch (microphysics) {
    case Microphysics::kWsm6:
      return "WSM6";
    case Microphysics::kWsm6WithHail:
      return "WSM6 with hail";
    case Microphysics::kThompson:
      return "Thompson";
    case Microphysics::kUnknown:
      break;
  }
  return "";
}

bool HasDistribution(Microphysics microphysics, Hydrometeor hydrometeor) {
  // Any content and temperature will do, because the existence of a distribution does not depend on
  // them.
  return Radius_m(microphysics, hydrometeor, 1e-3, 260.0).has_value();
}

float DistributionRadius_m(Microphysics microphysics, Hydrometeor hydrometeor,
                           float content_kg_per_m3, float temperature_K) {
  const std::optional<double> radius_m =
      Radius_m(microphysics, hydrometeor, content_kg_per_m3, temperature_K);
  THUNDERHEAD_CHECK(radius_m.has_value(), "no distribution is known");
  return std::clamp(static_cast<float>(*radius_m), kMinRadius_m, kMaxRadius_m);
}

}  // namespace thunderhead::physics
