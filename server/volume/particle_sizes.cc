#include "volume/particle_sizes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/half_float.h"
#include "physics/particle_size.h"

namespace thunderhead::volume {

void ToRadius(physics::Hydrometeor hydrometeor, const SizeVariable& variable,
              const std::vector<float>& mixing_ratios, std::vector<float>& sizes) {
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    float radius_m = sizes[i];
    if (variable.is_count) {
      // The comparisons fail for NaN, so such a cell gets no radius.
      const bool counted = sizes[i] > 0.0F && mixing_ratios[i] > 0.0F;
      radius_m =
          counted ? physics::EffectiveRadius_m(hydrometeor, mixing_ratios[i] / sizes[i]) : 0.0F;
    }
    const bool usable = radius_m >= physics::kMinRadius_m && radius_m <= physics::kMaxRadius_m;
    sizes[i] = usable ? radius_m : std::numeric_limits<float>::quiet_NaN();
  }
}

void ToConcentrationPerRadius(physics::Hydrometeor hydrometeor, physics::Microphysics microphysics,
                              const std::vector<float>& concentration_kg_per_m3,
                              const std::vector<float>& temperature_K, std::vector<float>& radii) {
  const bool distributed = physics::HasDistribution(microphysics, hydrometeor);
  const float observed_m = physics::DefaultOptics(hydrometeor).radius_m;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const float content = concentration_kg_per_m3[i];
    if (!(content > 0.0F)) {
      radii[i] = 0.0F;
      continue;
    }
    float radius_m = radii[i];
    if (std::isnan(radius_m)) {
      radius_m = distributed ? physics::DistributionRadius_m(
                                   microphysics, hydrometeor, content,
                                   temperature_K.empty() ? 0.0F : temperature_K[i])
                             : observed_m;
    }
    radii[i] = content / radius_m;
  }
}

ParticleSizes SizesOf(const ParticleSizes& origin, const std::vector<float>& concentration,
                      const std::vector<float>& concentration_per_radius) {
  ParticleSizes sizes;
  sizes.origin = origin.origin;
  sizes.name = origin.name;
  const auto has_some = [](float content) { return content > 0.0F; };
  const auto first = std::ranges::find_if(concentration, has_some);
  const auto last = std::find_if(concentration.rbegin(), concentration.rend(), has_some);
  if (first == concentration.end()) return sizes;
  sizes.first_cell = static_cast<std::size_t>(first - concentration.begin());
  sizes.inverse_radius.resize(static_cast<std::size_t>(last.base() - first));
  double mass = 0.0;
  double mass_per_radius = 0.0;
  for (std::size_t cell = sizes.first_cell; cell < sizes.EndCell(); ++cell) {
    if (!has_some(concentration[cell])) continue;
    const float inverse_radius_per_m =
        std::clamp(concentration_per_radius[cell] / concentration[cell],
                   1.0F / physics::kMaxRadius_m, 1.0F / physics::kMinRadius_m);
    sizes.inverse_radius[cell - sizes.first_cell] =
        base::HalfFromFloat(inverse_radius_per_m / kInverseRadiusUnit_per_m);
    mass += concentration[cell];
    mass_per_radius += static_cast<double>(concentration[cell]) * inverse_radius_per_m;
  }
  sizes.mean_radius_m = static_cast<float>(mass / mass_per_radius);
  return sizes;
}

}  // namespace thunderhead::volume
