// Views along, against and across the light, a sweep past 90 degrees, a camera inside the cloud, a
// sun at the horizon and below.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_format.h"
#include "base/status.h"
#include "frame/tone_map.h"
#include "measure/extremes_internal.h"
#include "renderers/scene_renderer.h"

namespace thunderhead::measure::internal {
namespace {

// See extremes_shape.cc.
constexpr double kSlantedError = 0.03;

Extreme AgainstLight(const accuracy::Path& path, const std::string& what,
                     double azimuth_deg, double elevation_deg) {
  return {absl::StrFormat("%s: view %s the light", path.name, what),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            const Look look{.view_azimuth_deg = azimuth_deg,
                            .view_elevation_deg = elevation_deg,
                            .sun_azimuth_deg = 70.0,
                            .sun_elevation_deg = 45.0};
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen,
                                         probe.Draw(PlainScene(path), *FieldsOf({}), look));
            const double sine = std::abs(std::sin(elevation_deg * std::numbers::pi / 180.0));
            return Sound(seen, Near(seen.transmittance, std::exp(-1.0 / sine), kSlantedError));
          }};
}

double MeanRadiance(const Seen& seen) {
  double sum = 0.0;
  for (std::size_t i = 0; i < seen.eye.size(); i += 4) sum += seen.eye[i];
  return sum / (static_cast<double>(seen.eye.size()) / 4.0);
}

// Past 90 degrees from the sun half-angle slices turn round. The picture must not pop there: the
// change over the step that does it is like the mean of the steps before and after.
Extreme Sweep(const accuracy::Path& path, const accuracy::Named<scene::Transport>& transport) {
  return {absl::StrFormat("%s: pop when the view passes 90 degrees from the sun, %s", path.name,
                          transport.name),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene;
            scene.rendering.technique = path.plain();
            scene::MediumSettingsOf(&scene.rendering.technique)->transport = transport.value;
            const auto fields = FieldsOf({.cells = glm::ivec3(24),
                                          .size_m = glm::dvec3(4000.0),
                                          .optical_depth = 20.0,
                                          .shape = Box::Shape::kRound});
            std::vector<double> means;
            for (const double apart_deg : {88.5, 89.5, 90.5, 91.5}) {
              const Look look{.view_azimuth_deg = 70.0 + apart_deg,
                              .view_elevation_deg = 0.0,
                              .sun_elevation_deg = 0.0,
                              .distance_in_boxes = 3.0,
                              .field_of_view_deg = 25.0,
                              .side_px = 33};
              THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen, probe.Draw(scene, *fields, look));
              if (!seen.unsound.empty()) return Sound(seen, {});
              means.push_back(MeanRadiance(seen));
            }
            const double around = 0.5 * (means[1] - means[0] + means[3] - means[2]);
            return AtMost(std::abs((means[2] - means[1] - around) / means[1]), 0.005);
          }};
}

Extreme InsideTheCloud(const accuracy::Path& path, double elevation_deg) {
  return {absl::StrFormat("%s: camera in the middle of the cloud, looking %s", path.name,
                          elevation_deg > 0.0 ? "down" : "up"),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            THUNDERHEAD_ASSIGN_OR_RETURN(
                const Seen seen,
                probe.Draw(PlainScene(path), *FieldsOf({.optical_depth = 2.0}),
                           {.view_elevation_deg = elevation_deg, .distance_in_boxes = 1e-6}));
            // Half the box lies before the eye; of the slice that it is in, all or nothing counts.
            return Sound(seen, Near(seen.transmittance, std::exp(-1.0), 0.02));
          }};
}

// A whole picture with sky and ground; below twilight it is dark.
Extreme LowSun(const accuracy::Path& path, double elevation_deg) {
  return {absl::StrFormat("%s: sun at %g degrees", path.name, elevation_deg),
          [=](Probe&) -> absl::StatusOr<Verdict> {
            scene::Scene scene;
            scene.rendering.technique = path.plain();
            scene::SetSlices(&scene.rendering.technique, 32);
            scene.sun.elevation_deg = elevation_deg;
            scene.output = {32, 18, 88};
            scene::OrbitCamera camera;
            camera.target_m.z = 2000.0;
            camera.distance_m = 12e3;
            scene.camera = camera;
            const std::shared_ptr<const volume::HydrometeorFields> fields = FieldsOf(
                {.size_m = glm::dvec3(4000.0), .optical_depth = 20.0, .shape = Box::Shape::kRound});
            renderers::SceneRenderer renderer;
            THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame frame,
                                         renderer.Draw(scene, fields, {}));
            const std::vector<float> linear = frame::ReadLinear(*frame.radiance);
            const bool usable = std::all_of(linear.begin(), linear.end(), [](float value) {
              return std::isfinite(value) && value >= 0.0F;
            });
            float brightest = 0.0F;
            for (std::size_t i = 0; i < linear.size(); ++i) {
              if (i % 4 != 3) brightest = std::max(brightest, linear[i]);
            }
            // A white surface facing the sun is at most 1 / pi; the sky beside it may be brighter.
            Verdict verdict = AtMost(brightest, elevation_deg <= -18.0 ? 1e-3 : 2.0);
            verdict.passed = verdict.passed && usable;
            if (!usable) verdict.got += ", and values that are no radiance";
            return verdict;
          }};
}

}  // namespace

void AppendViewExtremes(const accuracy::Path& path, std::vector<Extreme>* extremes) {
  extremes->push_back(AgainstLight(path, "along", 70.0, 45.0));
  extremes->push_back(AgainstLight(path, "against", 250.0, -45.0));
  extremes->push_back(AgainstLight(path, "across", 250.0, 45.0));
  extremes->push_back(AgainstLight(path, "a hair from across", 250.001, 45.0));
  for (const auto& transport : accuracy::kTransports) extremes->push_back(Sweep(path, transport));
  extremes->push_back(InsideTheCloud(path, 89.9));
  extremes->push_back(InsideTheCloud(path, -89.9));
  for (const double elevation_deg : {0.0, -0.5, -6.0, -18.0, -90.0}) {
    extremes->push_back(LowSun(path, elevation_deg));
  }
}

}  // namespace thunderhead::measure::internal
