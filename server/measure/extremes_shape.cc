// Test cases with domains of extreme sizes, cells of extreme shapes, volumes of one cell, too many
// cells, and empty volumes.
#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_format.h"
#include "base/status.h"
#include "measure/extremes_internal.h"

namespace thunderhead::measure::internal {
namespace {

Extreme Transmittance(const accuracy::PlainTechnique& plain, const std::string& what,
                      const Box& box, double elevation_deg) {
  return {absl::StrFormat("%s: %s", plain.name, what),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            const scene::Scene scene = PlainScene(plain);
            THUNDERHEAD_ASSIGN_OR_RETURN(
                const Seen seen,
                probe.Draw(scene, *FieldsOf(box), {.view_elevation_deg = elevation_deg}));
            const double sine = std::sin(elevation_deg * std::numbers::pi / 180.0);
            return TransmittanceNear(plain, seen, box.optical_depth / sine,
                                     elevation_deg > 89.0 ? kUpright : kSlanted,
                                     *scene::SlicesOf(scene.rendering.technique));
          }};
}

Extreme DomainSize(const accuracy::PlainTechnique& plain, double width_m) {
  return Transmittance(plain, absl::StrFormat("domain %g m wide", width_m),
                       {.size_m = glm::dvec3(width_m, width_m, width_m / 4)}, 89.9);
}

Extreme TooManyCells(const accuracy::PlainTechnique& plain) {
  return {absl::StrFormat("%s: more cells than a 3D texture holds", plain.name),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            GLint max_cells = 0;
            glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &max_cells);
            const auto fields = FieldsOf({.cells = glm::ivec3(max_cells + 77, 2, 2)});
            const scene::Scene scene = PlainScene(plain);
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen, probe.Draw(scene, *fields, {}));
            return TransmittanceNear(plain, seen, 1.0, kUpright,
                                     *scene::SlicesOf(scene.rendering.technique));
          }};
}

// Checks that an empty scene draws nothing: transmittance is exactly 1 and radiance exactly 0.
Extreme Nothing(const accuracy::PlainTechnique& plain, const std::string& what, const Box& box,
                bool visible) {
  return {absl::StrFormat("%s: %s", plain.name, what),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene = PlainScene(plain);
            for (scene::FieldParameters& field : scene.fields) field.visible = visible;
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen, probe.Draw(scene, *FieldsOf(box), {}));
            const bool clear = seen.transmittance == 1.0 && seen.radiance == 0.0;
            return Sound(seen, {"transmittance 1, radiance 0",
                                absl::StrFormat("transmittance %g, radiance %g", seen.transmittance,
                                                seen.radiance),
                                clear});
          }};
}

}  // namespace

void AppendShapeExtremes(const accuracy::PlainTechnique& plain, std::vector<Extreme>* extremes) {
  for (const double width_m : {10.0, 1e3, 1e5, 1e7})
    extremes->push_back(DomainSize(plain, width_m));
  const glm::dvec3 flat_m(16e3, 16e3, 160.0);
  const glm::dvec3 tall_m(160.0, 160.0, 16e3);
  extremes->push_back(
      Transmittance(plain, "cells 100 times as wide as high", {.size_m = flat_m}, 60.0));
  extremes->push_back(
      Transmittance(plain, "cells 100 times as high as wide", {.size_m = tall_m}, 89.9));
  extremes->push_back(Transmittance(plain, "one layer", {.cells = glm::ivec3(16, 16, 1)}, 89.9));
  extremes->push_back(
      Transmittance(plain, "one layer, slanted", {.cells = glm::ivec3(16, 16, 1)}, 50.0));
  extremes->push_back(Transmittance(plain, "one cell", {.cells = glm::ivec3(1)}, 89.9));
  extremes->push_back(TooManyCells(plain));
  extremes->push_back(Nothing(plain, "empty volume", {.optical_depth = 0.0}, true));
  extremes->push_back(Nothing(plain, "no visible field", {}, false));
}

}  // namespace thunderhead::measure::internal
