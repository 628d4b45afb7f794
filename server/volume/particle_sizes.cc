#include "volume/particle_sizes.h"

#include <algorithm>

#include "physics/particle_size.h"
#include "volume/extinction.h"

namespace thunderhead::volume {

void ToInverseRadius(physics::Hydrometeor hydrometeor, const SizeVariable& variable,
                     const std::vector<float>& mixing_ratios, std::vector<float>& sizes) {
  const float default_radius_m = physics::DefaultOptics(hydrometeor).radius_m;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    float radius_m = sizes[i];
    if (variable.is_count) {
      // Comparisons fail for NaN.
      const bool counted = sizes[i] > 0.0F && mixing_ratios[i] > 0.0F;
      radius_m =
          counted ? physics::EffectiveRadius_m(hydrometeor, mixing_ratios[i] / sizes[i]) : 0.0F;
    }
    const bool usable = radius_m >= physics::kMinRadius_m && radius_m <= physics::kMaxRadius_m;
    sizes[i] = 1.0F / (usable ? radius_m : default_radius_m);
  }
}

ParticleSizes SizesOf(const std::string& variable, const std::vector<float>& concentration,
                      const std::vector<float>& concentration_per_radius) {
  ParticleSizes sizes;
  sizes.variable = variable;
  sizes.inverse_radius.resize(concentration.size());
  double mass = 0.0;
  double mass_per_radius = 0.0;
  for (std::size_t i = 0; i < concentration.size(); ++i) {
    if (!(concentration[i] > 0.0F)) continue;
    const float inverse_radius_per_m =
        std::clamp(concentration_per_radius[i] / concentration[i], 1.0F / physics::kMaxRadius_m,
                   1.0F / physics::kMinRadius_m);
    sizes.inverse_radius[i] = HalfFromFloat(inverse_radius_per_m / kInverseRadiusUnit_per_m);
    mass += concentration[i];
    mass_per_radius += static_cast<double>(concentration[i]) * inverse_radius_per_m;
  }
  if (mass_per_radius > 0.0) sizes.mean_radius_m = static_cast<float>(mass / mass_per_radius);
  return sizes;
}

}  // namespace thunderhead::volume
