// Test cases with extreme views. The view is along, against or across the light, or moves past 90
// degrees from the sun. The camera is inside the cloud, or the sun is at the horizon or below.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_format.h"
#include "base/status.h"
#include "frame/tone_map.h"
#include "measure/extremes_internal.h"
#include "physics/sky.h"
#include "renderers/scene_renderer.h"
#include "scene/view.h"

namespace thunderhead::measure::internal {
namespace {

Extreme AgainstLight(const accuracy::PlainTechnique& plain, const std::string& what,
                     double azimuth_deg, double elevation_deg) {
  return {absl::StrFormat("%s: view %s the light", plain.name, what),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            const Look look{.view_azimuth_deg = azimuth_deg,
                            .view_elevation_deg = elevation_deg,
                            .sun_azimuth_deg = 70.0,
                            .sun_elevation_deg = 45.0};
            const scene::Scene scene = PlainScene(plain);
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen seen, probe.Draw(scene, *FieldsOf({}), look));
            const double sine = std::abs(std::sin(elevation_deg * std::numbers::pi / 180.0));
            return TransmittanceNear(plain, seen, 1.0 / sine, kSlanted,
                                     *scene::SlicesOf(scene.rendering.technique));
          }};
}

double MeanRadiance(const Seen& seen) {
  double sum = 0.0;
  for (std::size_t i = 0; i < seen.eye.size(); i += 4) sum += seen.eye[i];
  return sum / (static_cast<double>(seen.eye.size()) / 4.0);
}

// Checks a camera that moves past 90 degrees from the sun, where half-angle slices change their
// orientation. The picture must not jump there. The change over that step must be near the mean of
// the changes over the steps before and after it.
Extreme Sweep(const accuracy::PlainTechnique& plain,
              const accuracy::Named<scene::Transport>& transport) {
  return {absl::StrFormat("%s: pop when the view passes 90 degrees from the sun, %s", plain.name,
                          transport.name),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            scene::Scene scene;
            scene.rendering.technique = plain.settings();
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

// Checks that half-float and float buffers give the same picture.
Extreme HalfAgainstSingle(const accuracy::PlainTechnique& plain) {
  return {absl::StrFormat("%s: half-float buffers against float buffers", plain.name),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            const auto fields = SmoothCloud(20.0);
            Look look{.distance_in_boxes = 3.0, .field_of_view_deg = 25.0, .side_px = 33};
            scene::Scene scene;
            scene.rendering.technique = plain.settings();
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen half, probe.Draw(scene, *fields, look));
            look.single_precision = true;
            THUNDERHEAD_ASSIGN_OR_RETURN(const Seen single, probe.Draw(scene, *fields, look));
            if (half.eye == single.eye) {
              return Verdict{"two pictures", "one: both buffers are the same", false};
            }
            // The tolerance follows from the rounding error 2^-11 in the square root of the light's
            // optical depth, at an optical depth of a few.
            return Sound(half, Near(MeanRadiance(half) / MeanRadiance(single), 1.0, 0.002, 0.0));
          }};
}

Extreme InsideTheCloud(const accuracy::PlainTechnique& plain, double elevation_deg) {
  return {absl::StrFormat("%s: camera in the middle of the cloud, looking %s", plain.name,
                          elevation_deg > 0.0 ? "down" : "up"),
          [=](Probe& probe) -> absl::StatusOr<Verdict> {
            const scene::Scene scene = PlainScene(plain);
            THUNDERHEAD_ASSIGN_OR_RETURN(
                const Seen seen,
                probe.Draw(scene, *FieldsOf({.optical_depth = 2.0}),
                           {.view_elevation_deg = elevation_deg, .distance_in_boxes = 1e-6}));
            // Half of the box lies in front of the eye, with 64 half-angle slices. The slice that
            // contains the eye counts completely or not at all.
            constexpr DepthErrors kInside = {.half_angle = 1.0 / 64.0 + kUpright.half_angle,
                                             .light_volume = kUpright.light_volume};
            return TransmittanceNear(plain, seen, 1.0, kInside,
                                     *scene::SlicesOf(scene.rendering.technique));
          }};
}

// Returns a whole picture with sky and ground. It holds red, green and blue of each pixel.
absl::StatusOr<std::vector<float>> WholePicture(const scene::Scene& scene) {
  const std::shared_ptr<const volume::HydrometeorFields> fields =
      FieldsOf({.size_m = glm::dvec3(4000.0), .optical_depth = 20.0, .shape = Box::Shape::kRound});
  renderers::SceneRenderer renderer;
  THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame frame,
                               renderer.Draw(scene, fields, {.single_precision = true}));
  std::vector<float> colors;
  const std::vector<float> linear = frame::ReadLinear(*frame.radiance);
  for (std::size_t i = 0; i < linear.size(); ++i) {
    if (i % 4 != 3) colors.push_back(linear[i]);
  }
  return colors;
}

scene::Scene LowSunScene(const accuracy::PlainTechnique& plain, double elevation_deg) {
  scene::Scene scene;
  scene.rendering.technique = plain.settings();
  scene::SetSlices(&scene.rendering.technique, 32);
  scene.sun.elevation_deg = elevation_deg;
  scene.output = {.width_px = 32, .height_px = 18};
  scene::OrbitCamera camera;
  camera.target_m.z = 2000.0;
  camera.distance_m = 12e3;
  scene.camera = camera;
  return scene;
}

// Checks pictures with a low sun. The maximum radiance must be of the order of the sky's mean
// radiance (up to 10 times the mean near a setting sun). The storm must change the picture by at
// least a tenth of the mean, and be lit everywhere. No pixel may be darker than a tenth of its
// background. Deep in the night the whole picture must be black.
Verdict LowSunVerdict(const scene::Scene& scene, const std::vector<float>& storm,
                      const std::vector<float>& bare) {
  double brightest = 0.0;
  double changed = 0.0;
  double darkest = 1.0;  // relative to the background behind the pixel
  for (std::size_t i = 0; i < storm.size(); ++i) {
    if (!std::isfinite(storm[i]) || storm[i] < 0.0F) {
      return {"radiances", absl::StrFormat("%g in the picture", storm[i]), false};
    }
    brightest = std::max<double>(brightest, storm[i]);
    changed = std::max<double>(changed, std::abs(storm[i] - bare[i]));
    if (bare[i] > 0.0F) darkest = std::min<double>(darkest, storm[i] / bare[i]);
  }
  const physics::ClearSky sky(physics::Atmosphere(static_cast<float>(scene.sky.turbidity),
                                                  static_cast<float>(scene.sky.ground_albedo)),
                              glm::vec3(scene::Direction(0.0, scene.sun.elevation_deg)),
                              {.eye_m = 0.0F});
  const glm::vec3 light = sky.Light().mean_radiance;
  const double mean = scene.sky.brightness * std::max({light.x, light.y, light.z});
  return {absl::StrFormat("%.3g to %.3g, storm %.3g", 0.5 * mean, 10.0 * mean, 0.1 * mean),
          absl::StrFormat("%.3g, storm %.3g, darkest %.2g", brightest, changed, darkest),
          brightest >= 0.5 * mean && brightest <= 10.0 * mean && changed >= 0.1 * mean &&
              darkest >= 0.1};
}

Extreme LowSun(const accuracy::PlainTechnique& plain, double elevation_deg) {
  return {absl::StrFormat("%s: sun at %g degrees", plain.name, elevation_deg),
          [=](Probe&) -> absl::StatusOr<Verdict> {
            scene::Scene scene = LowSunScene(plain, elevation_deg);
            THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> storm, WholePicture(scene));
            for (scene::FieldParameters& field : scene.fields) field.visible = false;
            THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> bare, WholePicture(scene));
            return LowSunVerdict(scene, storm, bare);
          }};
}

}  // namespace

void AppendViewExtremes(const accuracy::PlainTechnique& plain, std::vector<Extreme>* extremes) {
  extremes->push_back(AgainstLight(plain, "along", 70.0, 45.0));
  extremes->push_back(AgainstLight(plain, "against", 250.0, -45.0));
  extremes->push_back(AgainstLight(plain, "across", 250.0, 45.0));
  extremes->push_back(AgainstLight(plain, "a hair from across", 250.001, 45.0));
  for (const auto& transport : accuracy::kTransportNames)
    extremes->push_back(Sweep(plain, transport));
  // The buffers of half-angle slicing are always floats, so only the light volume is tested.
  if (plain.name == scene::LightVolume::kName) extremes->push_back(HalfAgainstSingle(plain));
  extremes->push_back(InsideTheCloud(plain, 89.9));
  extremes->push_back(InsideTheCloud(plain, -89.9));
  for (const double elevation_deg : {0.0, -0.5, -6.0, -18.0, -90.0}) {
    extremes->push_back(LowSun(plain, elevation_deg));
  }
}

}  // namespace thunderhead::measure::internal
