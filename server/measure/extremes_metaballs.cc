// Test cases with metaballs at extreme optical depths, domains and cells. Fitted balls do not
// represent a box exactly, so the cases check that values are valid and within bounds.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "absl/strings/str_format.h"
#include "base/status.h"
#include "glm/geometric.hpp"
#include "measure/extremes_internal.h"
#include "renderers/metaball/ball_fit.h"
#include "renderers/metaball/wyvill.h"
#include "scene/view.h"
#include "shaders/bindings.h"

namespace thunderhead::measure::internal {
namespace {

constexpr accuracy::PlainTechnique kPlain = accuracy::Plain<scene::Metaballs>();
constexpr int kBalls = 200;

scene::Scene BallScene(scene::Transport transport) {
  scene::Scene scene = PlainScene(kPlain);
  scene.rendering.technique = accuracy::InMode(scene::Metaballs{.count = kBalls},
                                               accuracy::kUniformPhaseLowAlbedoMode, transport);
  return scene;
}

// Passes if `got` lies between `low` and `high`. `without` is the value for a picture without
// balls, which must lie outside this range.
Verdict Within(double got, double low, double high, double without) {
  Verdict verdict{absl::StrFormat("%g to %g", low, high), absl::StrFormat("%g", got),
                  got >= low && got <= high};
  if (without >= low && without <= high) {
    verdict.got += ", but the test would also pass without balls";
    verdict.passed = false;
  }
  return verdict;
}

// Passes if the transmittance of the middle ray lies between `low` and `high`.
Extreme Between(const std::string& what, const Box& box, const Look& look, double low,
                double high) {
  return {absl::StrFormat("%s: %s", kPlain.name, what),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            THUNDERHEAD_ASSIGN_OR_RETURN(
                const Seen seen,
                probe.Draw(BallScene(scene::Transport::kConsistent), *FieldsOf(box), look));
            return Sound(seen, Within(seen.transmittance, low,
                                      std::max<double>(high, shaders::kOpaqueTransmittance), 1.0));
          }};
}

// Checks the transmittance in the middle of a full box. The optical depth of the fitted balls may
// differ from the box's by at most a fifth.
Extreme Depth(double depth) {
  return Between(absl::StrFormat("optical depth %g", depth), {.optical_depth = depth}, {},
                 std::exp(-1.2 * depth), std::exp(-0.8 * depth));
}

// Checks the light that a thin box scatters once. It may differ from the expected light by at most
// a fifth. The light can be measured even if the box is so thin that its transmittance rounds to 1.
Extreme ThinLight(double depth) {
  return {absl::StrFormat("%s: light scattered at optical depth %g", kPlain.name, depth),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen,
                                         probe.Draw(BallScene(scene::Transport::kConsistent),
                                                    *FieldsOf({.optical_depth = depth}), {}));
            const double once = depth / (4.0 * std::numbers::pi);
            return Sound(seen, Within(seen.radiance, 0.8 * once, 1.2 * once, 0.0));
          }};
}

Extreme Empty() {
  return {absl::StrFormat("%s: empty volume", kPlain.name),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen,
                                         probe.Draw(BallScene(scene::Transport::kConsistent),
                                                    *FieldsOf({.optical_depth = 0.0}), {}));
            return Sound(
                seen, {"1", absl::StrFormat("%g", seen.transmittance), seen.transmittance == 1.0});
          }};
}

// Returns the optical depth of the balls along a ray from `origin_m`, as in P. Man, "Generating and
// Real-Time Rendering of Clouds". Each ball contributes a product of three factors. They are tau,
// the ball's density relative to the mean density (at most 1), and the ball's field function. The
// field function is taken at the point of the ray nearest to the ball's centre.
double PaperDepth(const std::vector<renderers::Ball>& balls, double tau, const glm::dvec3& origin_m,
                  const glm::dvec3& direction) {
  double sum = 0.0;
  for (const renderers::Ball& ball : balls) sum += ball.extinction_per_m;
  double depth = 0.0;
  for (const renderers::Ball& ball : balls) {
    const glm::dvec3 off_m = ball.middle_m - origin_m;
    const glm::dvec3 across_m = off_m - glm::dot(off_m, direction) * direction;
    const double s = 1.0 - glm::dot(across_m, across_m) / (ball.radius_m * ball.radius_m);
    const double density =
        std::min(ball.extinction_per_m * static_cast<double>(balls.size()) / sum, 1.0);
    depth += tau * density * renderers::glsl::wyvill_field(static_cast<float>(s));
  }
  return depth;
}

// In the paper's transport, densities are relative and the optical depth is a setting. The picture
// must therefore not depend on the storm's own optical depth.
Extreme Paper(double depth) {
  return {
      absl::StrFormat("%s: paper transport, optical depth %g", kPlain.name, depth),
      [=](Probe& probe) -> absl::StatusOr<Verdict> {
        scene::Scene scene = BallScene(scene::Transport::kPaper);
        auto& metaballs = std::get<scene::Metaballs>(scene.rendering.technique);
        metaballs.optical_depth = 0.5;
        const auto fields = FieldsOf({.optical_depth = depth});
        const Look look;
        THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen, probe.Draw(scene, *fields, look));
        THUNDERHEAD_ASSIGN_OR_RETURN(
            const renderers::BallCloud cloud,
            renderers::FitBalls(scene::GroupedFieldsOf(scene, *fields), *fields, kBalls));
        const volume::RegularGrid& grid = fields->grid;
        const double expected = std::exp(-PaperDepth(
            cloud.balls, metaballs.optical_depth, 0.5 * (grid.low_corner_m + grid.HighCorner_m()),
            scene::Direction(look.view_azimuth_deg, look.view_elevation_deg)));
        return Sound(seen, Near(seen.transmittance, expected, 1e-3, 1.0));
      }};
}

}  // namespace

void AppendMetaballExtremes(std::vector<Extreme>* extremes) {
  for (const double depth : {1e-8, 1e-4, 1e-2}) extremes->push_back(ThinLight(depth));
  for (const double depth : {1e-4, 1e-2, 1.0, 10.0, 1e4, 1e8}) extremes->push_back(Depth(depth));
  for (const double width_m : {10.0, 1e3, 1e5, 1e7}) {
    extremes->push_back(Between(absl::StrFormat("domain %g m wide", width_m),
                                {.size_m = {width_m, width_m, width_m / 4}}, {}, std::exp(-1.2),
                                std::exp(-0.8)));
  }
  extremes->push_back(Between("one cell", {.cells = glm::ivec3(1)}, {}, 0.0, std::exp(-0.5)));
  extremes->push_back(Between("camera inside", {.optical_depth = 10.0},
                              {.distance_in_boxes = 0.01, .field_of_view_deg = 60.0}, 0.0, 0.1));
  extremes->push_back(Between("sun on the horizon", {.optical_depth = 10.0},
                              {.sun_elevation_deg = 0.0}, 0.0, 1e-3));
  extremes->push_back(Empty());
  for (const double depth : {1e-4, 1.0, 1e8}) extremes->push_back(Paper(depth));
}

}  // namespace thunderhead::measure::internal
