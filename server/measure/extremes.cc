#include "measure/extremes.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "measure/extremes_internal.h"
#include "shaders/bindings.h"

namespace thunderhead::measure {
namespace internal {

namespace {

// Rounding error of a number near 1 in the light volume's half-float buffers.
constexpr double kHalfStep = 0x1p-11;

// Rounding error of each factor of a transmittance in single precision.
constexpr double kSingleStep = 0x1p-24;

}  // namespace

Verdict Near(double got, double expected, double tolerance, double without) {
  Verdict verdict = {absl::StrFormat("%.6g +- %.2g", expected, tolerance),
                     absl::StrFormat("%.6g", got), std::abs(got - expected) <= tolerance};
  if (std::abs(without - expected) <= tolerance) {
    absl::StrAppendFormat(&verdict.got, ", but the bound %.6g would also pass without any medium",
                          without);
    verdict.passed = false;
  }
  return verdict;
}

Verdict TransmittanceNear(const accuracy::PlainTechnique& plain, const Seen& seen, double depth,
                          const DepthErrors& errors, int slices, bool single_precision) {
  const bool light_volume = plain.name == scene::LightVolume::kName;
  const double expected = std::exp(-depth);
  const double depth_error = light_volume ? errors.light_volume : errors.half_angle;
  const double rounding =
      slices * kSingleStep + (light_volume && !single_precision ? kHalfStep : 0);
  const double opaque =
      expected < 2.0 * shaders::kOpaqueTransmittance ? shaders::kOpaqueTransmittance : 0.0;
  return Sound(seen, Near(seen.transmittance, expected,
                          depth_error * depth * expected + rounding + opaque, 1.0));
}

Verdict AtMost(double got, double bound) {
  return {absl::StrFormat("<= %.3g", bound), absl::StrFormat("%.4g", got), got <= bound};
}

Verdict Sound(const Seen& seen, Verdict verdict) {
  if (seen.unsound.empty()) return verdict;
  return {verdict.expected, absl::StrCat(verdict.got, ", but ", seen.unsound), false};
}

scene::Scene PlainScene(const accuracy::PlainTechnique& plain) {
  scene::Scene scene;
  scene.rendering.technique =
      InMode(plain.settings(), accuracy::kUniformPhaseLowAlbedoMode, scene::Transport::kConsistent);
  for (scene::FieldParameters& field : scene.fields) {
    field.optics.phase = {physics::PhaseKind::kHenyeyGreenstein, 0.0F};
  }
  return scene;
}

}  // namespace internal

std::vector<Extreme> Extremes() {
  std::vector<Extreme> extremes;
  internal::AppendInputExtremes(&extremes);
  for (const auto& plain : accuracy::kCellTechniques) {
    internal::AppendDepthExtremes(plain, &extremes);
    internal::AppendShapeExtremes(plain, &extremes);
    internal::AppendViewExtremes(plain, &extremes);
  }
  internal::AppendMetaballExtremes(&extremes);
  return extremes;
}

}  // namespace thunderhead::measure
