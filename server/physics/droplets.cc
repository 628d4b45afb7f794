#include "physics/droplets.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "physics/mie.h"
#include "physics/refractive_index.h"

namespace thunderhead::physics {
namespace {

double SizeParameter(double radius_um, std::size_t channel, double shift_um = 0.0) {
  return 2.0 * std::numbers::pi * radius_um / (kWavelengthsUm[channel] + shift_um);
}

std::complex<double> WaterIndex(std::size_t channel, double shift_um = 0.0) {
  return {WaterRefractiveIndex(kWavelengthsUm[channel] + shift_um), kWaterAbsorption[channel]};
}

// Returns the geometric cross section per logarithm of the radius, r^3 n(r), where r is the radius
// divided by the effective radius. It is scaled to 1 at its peak.
double AreaDensity(double r, double variance) {
  const double power = 1.0 / variance;
  return std::exp(power * (std::log(r) - r + 1.0));
}

}  // namespace

SizeQuadrature QuadratureOf(const DropletSizes& sizes, int count) {
  constexpr double kNegligible = 1e-7;
  double low = 1.0;
  double high = 1.0;
  while (AreaDensity(low, sizes.effective_variance) > kNegligible) low *= 0.98;
  while (AreaDensity(high, sizes.effective_variance) > kNegligible) high *= 1.02;
  const GaussLegendre gauss(count);
  SizeQuadrature quadrature;
  double sum = 0.0;
  for (int i = 0; i < count; ++i) {
    const double t = 0.5 * (1.0 + gauss.points[static_cast<std::size_t>(i)]);
    const double r = low * std::pow(high / low, t);
    const double share =
        gauss.weights[static_cast<std::size_t>(i)] * AreaDensity(r, sizes.effective_variance);
    quadrature.radii_um.push_back(r * sizes.effective_radius_um);
    quadrature.area_shares.push_back(share);
    sum += share;
  }
  for (double& share : quadrature.area_shares) share /= sum;
  return quadrature;
}

DropletOptics OpticsOf(const DropletSizes& sizes, int radii) {
  const SizeQuadrature quadrature = QuadratureOf(sizes, radii);
  DropletOptics optics;
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    double scattering = 0.0;
    for (std::size_t i = 0; i < quadrature.radii_um.size(); ++i) {
      const MieEfficiencies q =
          MieSeries(SizeParameter(quadrature.radii_um[i], c), WaterIndex(c)).Efficiencies();
      const double share = quadrature.area_shares[i];
      optics.extinction[c] += share * q.extinction;
      scattering += share * q.scattering;
      optics.asymmetry[c] += share * q.scattering * q.asymmetry;
    }
    optics.asymmetry[c] /= scattering;
    optics.albedo[c] = scattering / optics.extinction[c];
  }
  return optics;
}

double MassExtinction_m2_per_kg(const DropletSizes& sizes, double efficiency) {
  return 3.0 * efficiency / (4.0 * 1000.0 * sizes.effective_radius_um * 1e-6);
}

PhaseAccumulator ScatterByDroplets(const DropletSizes& sizes, const std::vector<double>& angles_deg,
                                   int radii, int points, const WorkPlan& plan, double shift_um) {
  const SizeQuadrature drops = QuadratureOf(sizes, radii);
  const AngleQuadrature angles = QuadratureOf(angles_deg, points);
  std::vector<double> cosines;
  for (const double angle : angles.angles_rad) cosines.push_back(std::cos(angle));

  // Drops are distributed to the chunks in turn, so that every chunk has small and large drops.
  constexpr int kChunks = 64;
  using Sums = std::array<std::vector<double>, kPhaseChannels>;
  std::vector<Sums> chunk_sums(kChunks);
  ForEachChunk(kChunks, plan, [&](int chunk) {
    Sums& sums = chunk_sums[static_cast<std::size_t>(chunk)];
    for (std::size_t c = 0; c < kPhaseChannels; ++c) {
      sums[c].assign(cosines.size(), 0.0);
      for (std::size_t i = static_cast<std::size_t>(chunk); i < drops.radii_um.size();
           i += kChunks) {
        const double x = SizeParameter(drops.radii_um[i], c, shift_um);
        // |s|^2 / x^2 is the scattering relative to the geometric cross section.
        MieSeries(x, WaterIndex(c, shift_um))
            .AddIntensities(cosines, drops.area_shares[i] / (x * x), sums[c]);
      }
    }
  });

  PhaseAccumulator scattered(angles_deg);
  for (const Sums& sums : chunk_sums) {
    for (std::size_t c = 0; c < kPhaseChannels; ++c) {
      for (std::size_t j = 0; j < cosines.size(); ++j) {
        scattered.Add(angles.angles_rad[j], angles.weights[j] * sums[c][j], c);
      }
    }
  }
  return scattered;
}

}  // namespace thunderhead::physics
