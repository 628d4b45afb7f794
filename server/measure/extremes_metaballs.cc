// What metaballs make of optical depths, domains and cells of all sizes. A fit is no exact picture
// of a box, so that what is asked for is soundness, and a bound.
#include <algorithm>
#include <cmath>
#include <string>

#include "absl/strings/str_format.h"
#include "base/status.h"
#include "measure/extremes_internal.h"

namespace thunderhead::measure::internal {
namespace {

constexpr const accuracy::Path& kPath = accuracy::kPaths[2];
constexpr int kBalls = 200;

// The middle ray's transmittance is between `least` and `highest`, whatever the fit.
Extreme Between(const std::string& what, const Box& box, const Look& look,
                scene::Transport transport, double least, double highest) {
  const double most = std::max(highest, kOpaque);
  return {absl::StrFormat("%s: %s", kPath.name, what),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene = PlainScene(kPath);
            scene.rendering.technique = accuracy::InMode(scene::Metaballs{.count = kBalls},
                                                         accuracy::kModes[0], transport);
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen, probe.Draw(scene, *FieldsOf(box), look));
            return Sound(seen, {absl::StrFormat("%g to %g", least, most),
                                absl::StrFormat("%g", seen.transmittance),
                                seen.transmittance >= least && seen.transmittance <= most});
          }};
}

// Of a full box, in the middle of which the fit is within a fifth of the depth.
Extreme Depth(double depth) {
  const double off = 0.2 * depth + (depth < 2e-3 ? 2e-3 : 0.0);
  return Between(absl::StrFormat("optical depth %g", depth), {.optical_depth = depth}, {},
                 scene::Transport::kConsistent, std::exp(-depth - off),
                 std::min(std::exp(-depth + off), 1.0));
}

}  // namespace

void AppendMetaballExtremes(std::vector<Extreme>* extremes) {
  for (const double depth : {1e-8, 1e-4, 1e-2, 1.0, 10.0, 1e4, 1e8}) {
    extremes->push_back(Depth(depth));
  }
  constexpr auto kConsistent = scene::Transport::kConsistent;
  for (const double width_m : {10.0, 1e3, 1e5, 1e7}) {
    extremes->push_back(Between(absl::StrFormat("domain %g m wide", width_m),
                                {.size_m = {width_m, width_m, width_m / 4}}, {}, kConsistent,
                                std::exp(-1.2), std::exp(-0.8)));
  }
  extremes->push_back(
      Between("one cell", {.cells = glm::ivec3(1)}, {}, kConsistent, 0.0, std::exp(-0.5)));
  extremes->push_back(Between("camera inside", {.optical_depth = 10.0},
                              {.distance_in_boxes = 0.01, .field_of_view_deg = 60.0}, kConsistent,
                              0.0, 0.1));
  extremes->push_back(Between("sun on the horizon", {.optical_depth = 10.0},
                              {.sun_elevation_deg = 0.0}, kConsistent, 0.0, 1e-3));
  extremes->push_back(Between("empty volume", {.optical_depth = 0.0}, {}, kConsistent, 1.0, 1.0));
  for (const double depth : {1e-4, 1.0, 1e8}) {
    extremes->push_back(Between(absl::StrFormat("paper transport, optical depth %g", depth),
                                {.optical_depth = depth}, {}, scene::Transport::kPaper, 0.0, 1.0));
  }
}

}  // namespace thunderhead::measure::internal
