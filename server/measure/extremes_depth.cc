// Test cases with extreme optical depths, numbers of slices and particle radii.
#include <cmath>
#include <limits>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "measure/extremes_internal.h"
#include "measure/soundness.h"
#include "renderers/group_weights.h"
#include "renderers/medium.h"

namespace thunderhead::measure::internal {
namespace {

// Optical depth below which media are drawn in single precision. Half floats cannot represent
// opacities below 5e-4 or radiances below 6e-8.
constexpr double kThin = 0.01;

// Returns the radiance of isotropic single scattering by a layer with any vertical profile. The
// layer is lit and seen from the zenith.
double Reflected(double depth) { return -std::expm1(-2.0 * depth) / 2.0 / (4 * std::numbers::pi); }

constexpr int kFewSlices = 8;

Extreme DepthPerSlice(const accuracy::PlainTechnique& plain, double per_slice,
                      const accuracy::Named<scene::Transport>& transport) {
  const std::string name =
      absl::StrFormat("%s: optical depth per slice %g, %s", plain.name, per_slice, transport.name);
  return {name, [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene;
            scene.rendering.technique = plain.settings();
            scene::MediumSettingsOf(&scene.rendering.technique)->transport = transport.value;
            scene::SetSlices(&scene.rendering.technique, kFewSlices);
            const double depth = kFewSlices * per_slice;
            const bool thin = depth < kThin;
            const auto fields = FieldsOf({.optical_depth = depth});
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen,
                                         probe.Draw(scene, *fields, {.single_precision = thin}));
            // The extinction along the ray towards the eye is scaled. Delta scaling removes the
            // forward peak from it. In diffusion transport, similarity scaling removes all forward
            // scattering.
            const renderers::GroupWeights weights(
                scene::GroupedFieldsOf(scene, *fields),
                *scene::MediumSettingsOf(scene.rendering.technique));
            const bool similar = transport.value == scene::Transport::kDiffusion &&
                                 accuracy::ShowsTransport(plain.settings(), transport.value);
            const std::vector<double>& lost = similar ? weights.transport : weights.eye;
            return TransmittanceNear(plain, seen, depth * lost.front(), kUpright, kFewSlices, thin);
          }};
}

// Ratio of a thin layer's reflectance in the paper's transport to the exact reflectance. The
// paper's display normalisation shows an isotropic phase function as white, with the value 1/2
// (common/phase.glsl). The exact value is 1 / (4 pi).
constexpr double kPaperBrightness = 2.0 * std::numbers::pi;

// Checks light scattered by slices that are so thin that light is scattered only once. Radiance
// must be proportional to the optical depth. Transmittance could not show this, because 1 - 1e-8
// rounds to 1 in single precision.
Extreme ThinSlices(const accuracy::PlainTechnique& plain, double per_slice,
                   const accuracy::Named<scene::Transport>& transport) {
  const std::string name = absl::StrFormat("%s: light scattered by slices of optical depth %g, %s",
                                           plain.name, per_slice, transport.name);
  return {name, [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene = PlainScene(plain);
            scene.rendering.technique = accuracy::InMode(
                plain.settings(), accuracy::kUniformPhaseTranslucentMode, transport.value);
            scene::SetSlices(&scene.rendering.technique, kFewSlices);
            const double depth = kFewSlices * per_slice;
            THUNDERHEAD_ASSIGN_OR_RETURN(
                const Seen seen,
                probe.Draw(scene, *FieldsOf({.optical_depth = depth}), {.single_precision = true}));
            const double expected =
                Reflected(depth) *
                (transport.value == scene::Transport::kPaper ? kPaperBrightness : 1.0);
            return Sound(seen, Near(seen.radiance, expected, 0.01 * expected, 0.0));
          }};
}

Extreme ReflectedLight(const accuracy::PlainTechnique& plain, double depth, int slices) {
  const std::string name = absl::StrFormat("%s: reflected light, optical depth %g in %d slices",
                                           plain.name, depth, slices);
  return {name, [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene = PlainScene(plain);
            scene::SetSlices(&scene.rendering.technique, slices);
            const auto fields = FieldsOf({.optical_depth = depth, .shape = Box::Shape::kLayer});
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen, probe.Draw(scene, *fields, {}));
            return Sound(seen, Near(seen.radiance, Reflected(depth), 0.05 * Reflected(depth), 0.0));
          }};
}

Extreme Slices(const accuracy::PlainTechnique& plain, int slices) {
  return {absl::StrFormat("%s: %d slices, transmittance", plain.name, slices),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene = PlainScene(plain);
            scene::SetSlices(&scene.rendering.technique, slices);
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen, probe.Draw(scene, *FieldsOf({}), {}));
            return TransmittanceNear(plain, seen, 1.0, kUpright, slices);
          }};
}

Extreme Radius(const accuracy::PlainTechnique& plain, float radius_m) {
  return {absl::StrFormat("%s: radius %g m", plain.name, radius_m),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene = PlainScene(plain);
            scene::FieldParameters& cloud =
                scene.fields[physics::IndexOf(physics::Hydrometeor::kCloud)];
            // The optical depth is inversely proportional to the radius, because the amount of
            // water stays the same.
            const double depth = static_cast<double>(cloud.optics.radius_m) / radius_m;
            const bool thin = depth < kThin;
            cloud.sizes = physics::SizeSource::kGiven;
            cloud.optics.radius_m = radius_m;
            THUNDERHEAD_ASSIGN_OR_RETURN(
                const Seen seen, probe.Draw(scene, *FieldsOf({}), {.single_precision = thin}));
            return TransmittanceNear(plain, seen, depth, kUpright,
                                     *scene::SlicesOf(scene.rendering.technique), thin);
          }};
}

// Checks the energy if all scattered light continues forwards. The energy must not grow.
Extreme LightEnergy(const accuracy::PlainTechnique& plain,
                    const accuracy::Named<scene::Transport>& transport) {
  return {absl::StrFormat("%s: light never exceeds the incoming light, theta_f 90, %s", plain.name,
                          transport.name),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene;
            scene.rendering.technique = plain.settings();
            scene::MediumSettingsOf(&scene.rendering.technique)->transport = transport.value;
            scene::MediumSettingsOf(&scene.rendering.technique)->theta_f_deg = 90.0;
            THUNDERHEAD_ASSIGN_OR_RETURN(
                const Seen seen, probe.Draw(scene, *FieldsOf({.optical_depth = 100.0}), {}));
            // The eye sees the multiply scattered light that returns towards the sun. A deep cloud
            // without absorption returns the most light. The paper's radiances have a different
            // unit.
            const double most = transport.value == scene::Transport::kPaper
                                    ? std::numeric_limits<double>::infinity()
                                    : kMaxFluence / (4.0 * std::numbers::pi);
            // If no light were lost, the medium would have no effect.
            const bool lit = seen.least_light < 0.999 && seen.radiance > 0.0;
            return Sound(
                seen, {absl::StrFormat(
                           "light and transmittance from 0 to 1, some light lost, radiance above 0 "
                           "and at most %g",
                           most),
                       absl::StrFormat("least light %g, seen %g", seen.least_light, seen.radiance),
                       lit && seen.radiance <= most});
          }};
}

}  // namespace

void AppendDepthExtremes(const accuracy::PlainTechnique& plain, std::vector<Extreme>* extremes) {
  for (const auto& transport : accuracy::kTransportNames) {
    for (const double per_slice : {1e-8, 1e-4}) {
      extremes->push_back(ThinSlices(plain, per_slice, transport));
    }
    for (const double per_slice : {1e-4, 1e-2, 1.0, 1e4, 1e8}) {
      extremes->push_back(DepthPerSlice(plain, per_slice, transport));
    }
  }
  for (const double depth : {2e-3, 1e-2, 1.0, 100.0, 1e4, 1e9}) {
    extremes->push_back(ReflectedLight(plain, depth, 128));
  }
  extremes->push_back(ReflectedLight(plain, 0.01, 4096));
  for (const int slices : {1, 2, 16, 4096}) extremes->push_back(Slices(plain, slices));
  for (const float radius_m : {1e-7F, 1e-6F, 1e-3F, 1e-1F}) {
    extremes->push_back(Radius(plain, radius_m));
  }
  for (const auto& transport : accuracy::kTransportNames)
    extremes->push_back(LightEnergy(plain, transport));
}

}  // namespace thunderhead::measure::internal
