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

scene::Scene PlainScene(const accuracy::Path& path) {
  scene::Scene scene;
  scene.rendering.technique =
      InMode(path.plain(), accuracy::kModes[0], scene::Transport::kConsistent);
  for (scene::FieldParameters& field : scene.fields) {
    field.optics.phase = {physics::PhaseKind::kHenyeyGreenstein, 0.0F};
  }
  return scene;
}

}  // namespace internal

std::vector<Extreme> Extremes() {
  std::vector<Extreme> extremes;
  internal::AppendInputExtremes(&extremes);
  for (const auto& path : accuracy::kFieldPaths) {
    internal::AppendDepthExtremes(path, &extremes);
    internal::AppendShapeExtremes(path, &extremes);
    internal::AppendViewExtremes(path, &extremes);
  }
  internal::AppendMetaballExtremes(&extremes);
  return extremes;
}

}  // namespace thunderhead::measure
