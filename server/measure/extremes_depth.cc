// Optical depths, numbers of slices, radii.
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "measure/extremes_internal.h"
#include "renderers/group_weights.h"
#include "renderers/medium.h"

namespace thunderhead::measure::internal {
namespace {

// A camera 0.1 degrees off the zenith tilts slices by as much: they extend 0.4 % beyond the box.
// Extinction is stored in half floats.
constexpr double kDepthError = 0.005;

// Of a transmittance near 1 in a half-float buffer.
constexpr double kHalfStep = 0x1p-11;

// Optical depth that is not drawn (volume/extinction.h).
constexpr double kNegligible = volume::kNegligibleOpticalDepth;

Verdict TransmittanceNear(const Seen& seen, double depth) {
  const double expected = std::exp(-depth);
  const double left_out = depth < kNegligible ? depth : 0.0;
  const double opaque = expected < 0.5 ? kOpaque : 0.0;
  return Sound(seen, Near(seen.transmittance, expected,
                          kDepthError * depth * expected + kHalfStep + opaque + left_out));
}

// Single scattering, same in all directions, of a layer lit and seen from straight above, whatever
// its profile.
double Reflected(double depth) { return -std::expm1(-2.0 * depth) / 2.0 / (4 * std::numbers::pi); }

Extreme DepthPerSlice(const accuracy::Path& path, double per_slice,
                      const accuracy::Named<scene::Transport>& transport) {
  const std::string name =
      absl::StrFormat("%s: optical depth per slice %g, %s", path.name, per_slice, transport.name);
  return {name, [=](Probe& probe) -> absl::StatusOr<Verdict> {
            constexpr int kSlices = 8;
            scene::Scene scene;
            scene.rendering.technique = path.plain();
            scene::MediumSettingsOf(&scene.rendering.technique)->transport = transport.value;
            scene::SetSlices(&scene.rendering.technique, kSlices);
            const auto fields = FieldsOf({.optical_depth = kSlices * per_slice});
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen, probe.Draw(scene, *fields, {}));
            // Delta scaling takes the forward peak out of what the eye loses, similarity scaling
            // all that goes on forward.
            const renderers::GroupWeights weights(renderers::MediumOf(scene, *fields),
                                                  *scene::MediumSettingsOf(scene.rendering.technique));
            const bool similar = transport.value == scene::Transport::kDiffusion &&
                                 path.name == scene::LightVolume::kName;
            const std::vector<double>& lost = similar ? weights.transport : weights.eye;
            return TransmittanceNear(seen, kSlices * per_slice * lost.front());
          }};
}

Extreme ReflectedLight(const accuracy::Path& path, double depth, int slices) {
  const std::string name = absl::StrFormat("%s: reflected light, optical depth %g in %d slices",
                                           path.name, depth, slices);
  return {name, [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene = PlainScene(path);
            scene::SetSlices(&scene.rendering.technique, slices);
            const auto fields = FieldsOf({.optical_depth = depth, .shape = Box::Shape::kLayer});
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen, probe.Draw(scene, *fields, {}));
            return Sound(seen, Near(seen.radiance, Reflected(depth), 0.05 * Reflected(depth)));
          }};
}

Extreme Slices(const accuracy::Path& path, int slices) {
  return {absl::StrFormat("%s: %d slices, transmittance", path.name, slices),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene = PlainScene(path);
            scene::SetSlices(&scene.rendering.technique, slices);
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen, probe.Draw(scene, *FieldsOf({}), {}));
            return TransmittanceNear(seen, 1.0);
          }};
}

Extreme Radius(const accuracy::Path& path, float radius_m) {
  return {absl::StrFormat("%s: radius %g m", path.name, radius_m),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene = PlainScene(path);
            physics::ParticleOptics& cloud =
                scene.fields[physics::IndexOf(physics::Hydrometeor::kCloud)].optics;
            // Extinction goes with one over the radius.
            const double depth = static_cast<double>(cloud.radius_m) / radius_m;
            cloud.radius_m = radius_m;
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen, probe.Draw(scene, *FieldsOf({}), {}));
            return TransmittanceNear(seen, depth);
          }};
}

// All light that is scattered goes on forwards, and not a bit more.
Extreme LightEnergy(const accuracy::Path& path, const accuracy::Named<scene::Transport>& transport) {
  return {absl::StrFormat("%s: light is never more than came in, theta_f 90, %s", path.name,
                          transport.name),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene;
            scene.rendering.technique = path.plain();
            scene::MediumSettingsOf(&scene.rendering.technique)->transport = transport.value;
            scene::MediumSettingsOf(&scene.rendering.technique)->theta_f_deg = 90.0;
            THUNDERHEAD_ASSIGN_OR_RETURN(
                const Seen seen, probe.Draw(scene, *FieldsOf({.optical_depth = 100.0}), {}));
            const char* const sound = "light and transmittance within 0 to 1";
            return Sound(seen, Verdict{sound, seen.unsound.empty() ? sound : "", true});
          }};
}

}  // namespace

void AppendDepthExtremes(const accuracy::Path& path, std::vector<Extreme>* extremes) {
  for (const double per_slice : {1e-8, 1e-4, 1e-2, 1.0, 1e4, 1e8}) {
    for (const auto& transport : accuracy::kTransports) {
      extremes->push_back(DepthPerSlice(path, per_slice, transport));
    }
  }
  for (const double depth : {2e-3, 1e-2, 1.0, 100.0, 1e4, 1e9}) {
    extremes->push_back(ReflectedLight(path, depth, 128));
  }
  extremes->push_back(ReflectedLight(path, 0.01, 4096));
  for (const int slices : {1, 2, 16, 4096}) extremes->push_back(Slices(path, slices));
  for (const float radius_m : {1e-7F, 1e-6F, 1e-3F, 1e-1F}) {
    extremes->push_back(Radius(path, radius_m));
  }
  for (const auto& transport : accuracy::kTransports) extremes->push_back(LightEnergy(path, transport));
}

}  // namespace thunderhead::measure::internal
