#include "measure/probe.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "frame/tone_map.h"
#include "glm/geometric.hpp"
#include "measure/soundness.h"
#include "renderers/group_weights.h"
#include "renderers/half_angle/half_angle_renderer.h"
#include "renderers/light_volume/light_volume_renderer.h"
#include "renderers/metaball/ball_fit.h"
#include "renderers/metaball/metaball_renderer.h"
#include "scene/view.h"

namespace thunderhead::measure {
namespace {

// Exponent of the Gaussian of the round box. Its extinction falls to 0.25 % at the box's faces.
constexpr double kSteepness = 24.0;

renderers::RenderSettings SettingsOf(const scene::Scene& scene,
                                     const volume::HydrometeorFields& fields, const Look& look) {
  const volume::RegularGrid& grid = fields.grid;
  const glm::dvec3 size_m = grid.HighCorner_m() - grid.low_corner_m;
  scene::OrbitCamera camera;
  camera.target_m = 0.5 * (grid.low_corner_m + grid.HighCorner_m());
  camera.azimuth_deg = look.view_azimuth_deg;
  camera.elevation_deg = look.view_elevation_deg;
  camera.distance_m = std::max({size_m.x, size_m.y, size_m.z}) * look.distance_in_boxes;
  camera.field_of_view_deg = look.field_of_view_deg;
  renderers::RenderSettings settings;
  settings.technique = scene.rendering.technique;
  settings.view = scene::ViewOf(camera, 1.0);
  settings.illumination = {scene::Direction(look.sun_azimuth_deg, look.sun_elevation_deg),
                           glm::vec3(1.0F), glm::vec3(0.0F)};
  settings.eye_size = glm::ivec2(look.side_px);
  settings.slices = scene::SlicesOf(scene.rendering.technique).value_or(settings.slices);
  settings.quality.single_precision = look.single_precision;
  return settings;
}

// Returns the extinction at `place`, relative to that of a full box with the same optical depth.
// Coordinates of `place` are from -1/2 to 1/2.
double ShareAt(Box::Shape shape, const glm::dvec3& place) {
  switch (shape) {
    case Box::Shape::kFull:
      break;
    case Box::Shape::kLayer:
      return std::abs(place.z) < 0.25 ? 2.0 : 0.0;
    case Box::Shape::kRound:
      return std::exp(-kSteepness * glm::dot(place, place));
  }
  return 1.0;
}

}  // namespace

std::shared_ptr<volume::HydrometeorFields> FieldsOf(const Box& box) {
  auto fields = std::make_shared<volume::HydrometeorFields>();
  volume::RegularGrid& grid = fields->grid;
  grid.cells = box.cells;
  grid.spacing_m = box.size_m / glm::dvec3(box.cells);
  grid.low_corner_m = {-box.size_m.x / 2, -box.size_m.y / 2, 0.0};
  const physics::ParticleOptics& cloud = physics::DefaultOptics(physics::Hydrometeor::kCloud);
  const double full_kg_per_m3 =
      box.optical_depth / box.size_m.z /
      physics::MassExtinction_m2_per_kg(cloud.density_kg_per_m3, cloud.radius_m);
  volume::HydrometeorField field;
  field.hydrometeor = physics::Hydrometeor::kCloud;
  for (int z = 0; z < box.cells.z; ++z) {
    for (int y = 0; y < box.cells.y; ++y) {
      for (int x = 0; x < box.cells.x; ++x) {
        const glm::dvec3 place = (glm::dvec3(x, y, z) + 0.5) / glm::dvec3(box.cells) - 0.5;
        field.concentration_kg_per_m3.push_back(
            static_cast<float>(full_kg_per_m3 * ShareAt(box.shape, place)));
      }
    }
  }
  fields->fields.push_back(std::move(field));
  const int empty = box.shape == Box::Shape::kLayer ? box.cells.z / 4 : 0;
  fields->condensate = {{0, 0, empty}, {box.cells.x, box.cells.y, box.cells.z - empty}};
  return fields;
}

std::shared_ptr<const volume::HydrometeorFields> SmoothCloud(double optical_depth) {
  // The mean of the Gaussian over a side of the box, whose ends are practically at infinity.
  const double mean = std::sqrt(std::numbers::pi / kSteepness);
  return FieldsOf({.cells = glm::ivec3(32),
                   .size_m = glm::dvec3(4000.0),
                   .optical_depth = optical_depth / mean,
                   .shape = Box::Shape::kRound});
}

absl::StatusOr<Seen> Probe::Draw(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                                 const Look& look) {
  renderers::ResidentMedium::Cost cost;
  renderers::DetailNoises noises;
  const renderers::ResidentMedium medium(scene, fields, &noises, &cost);
  if (medium.Empty()) return Seen{};
  const renderers::RenderSettings settings = SettingsOf(scene, fields, look);
  Seen seen;
  Soundness light;
  const scene::Technique& technique = scene.rendering.technique;
  if (std::holds_alternative<scene::HalfAngle>(technique)) {
    renderers::HalfAngleRenderer renderer(programs_);
    THUNDERHEAD_RETURN_IF_ERROR(renderer.Render(medium, settings, true));
    seen.eye = frame::ReadLinear(renderer.Eye());
    light = LightBufferSoundness(renderer.Light());
  } else if (const auto* metaballs = std::get_if<scene::Metaballs>(&technique)) {
    renderers::MetaballRenderer renderer(programs_);
    THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::BallCloud balls,
                                 renderers::FitBalls(medium.Content(), fields, metaballs->count));
    THUNDERHEAD_RETURN_IF_ERROR(renderer.CarryLight(balls, medium.Content(), settings));
    THUNDERHEAD_RETURN_IF_ERROR(renderer.DrawView(settings));
    seen.eye = frame::ReadLinear(renderer.Eye());
  } else if (std::holds_alternative<scene::LightVolume>(technique)) {
    renderers::LightVolumeRenderer renderer(programs_);
    THUNDERHEAD_RETURN_IF_ERROR(renderer.CarryLight(medium, settings));
    light = LightVolumeSoundness(renderer);
    if (settings.Medium().transport == scene::Transport::kDiffusion) {
      const renderers::GroupWeights weights(medium.Content(), settings.Medium());
      const Soundness diffuse =
          DiffusionSoundness(renderer, weights.transport.front() / weights.eye.front());
      if (light.unsound.empty()) light.unsound = diffuse.unsound;
    }
    THUNDERHEAD_RETURN_IF_ERROR(renderer.DrawView(medium, settings));
    seen.eye = frame::ReadLinear(renderer.Eye());
  } else {
    return absl::UnimplementedError(absl::StrCat(
        "the technique ", std::string(scene::NameOf(technique)), " cannot be probed; choose ",
        std::string(scene::LightVolume::kName), ", ", std::string(scene::HalfAngle::kName), " or ",
        std::string(scene::Metaballs::kName)));
  }
  seen.unsound = UnsoundPicture(seen.eye);
  if (seen.unsound.empty()) seen.unsound = light.unsound;
  seen.least_light = light.least_light;
  const std::size_t middle = seen.eye.size() / 4 / 2 * 4;
  seen.radiance = seen.eye[middle];
  seen.transmittance = seen.eye[middle + 3];
  return seen;
}

}  // namespace thunderhead::measure
