#include "measure/extremes.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "measure/extremes_internal.h"

namespace thunderhead::measure {
namespace internal {

Verdict Near(double got, double expected, double tolerance) {
  return {absl::StrFormat("%.6g +- %.2g", expected, tolerance), absl::StrFormat("%.6g", got),
          std::abs(got - expected) <= tolerance};
}

Verdict AtMost(double got, double most) {
  return {absl::StrFormat("<= %.3g", most), absl::StrFormat("%.4g", got), got <= most};
}

Verdict Sound(const Seen& seen, Verdict verdict) {
  if (seen.unsound.empty()) return verdict;
  return {verdict.expected, absl::StrCat(verdict.got, ", but ", seen.unsound), false};
}

scene::Scene PlainScene(scene::Renderer renderer) {
  scene::Scene scene;
  scene.rendering.renderer = renderer;
  scene.rendering.mode = scene::Mode::kUniformPhaseLowAlbedo;
  scene.rendering.transport = scene::Transport::kConsistent;
  for (scene::FieldParameters& field : scene.fields) {
    field.optics.phase = {physics::PhaseKind::kHenyeyGreenstein, 0.0F};
  }
  return scene;
}

}  // namespace internal

std::vector<Extreme> Extremes() {
  std::vector<Extreme> extremes;
  internal::AppendInputExtremes(&extremes);
  for (const auto& path : kFieldPaths) {
    internal::AppendDepthExtremes(path, &extremes);
    internal::AppendShapeExtremes(path, &extremes);
    internal::AppendViewExtremes(path, &extremes);
  }
  internal::AppendMetaballExtremes(&extremes);
  return extremes;
}

}  // namespace thunderhead::measure
