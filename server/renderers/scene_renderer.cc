#include "renderers/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/status.h"
#include "base/stopwatch.h"
#include "glm/geometric.hpp"
#include "physics/sky.h"
#include "renderers/view_uniforms.h"
#include "scene/view.h"
#include "volume/terrain.h"

namespace thunderhead::renderers {
namespace {

constexpr GLuint kEyeUnit = 4;
constexpr glm::vec3 kGroundTint(1.0F, 0.93F, 0.78F);  // of bare soil and grass seen from far off

glm::vec3 GroundRadiance(const scene::Scene& scene, const glm::vec3& towards_sun,
                         const physics::SkyLight& sky) {
  const float sine = std::max(towards_sun.z, 0.0F);
  const glm::vec3 direct = physics::glsl::sun_transmittance(towards_sun.z) * sine;
  const glm::vec3 diffuse = sky.irradiance * static_cast<float>(scene.sky.brightness);
  const auto reflected =
      static_cast<float>(scene.sun.irradiance * scene.sky.ground_albedo * std::numbers::inv_pi);
  return (direct + diffuse) * kGroundTint * reflected;
}

Illumination IlluminationOf(const scene::Scene& scene) {
  Illumination light;
  light.towards_sun = scene::Direction(scene.sun.azimuth_deg, scene.sun.elevation_deg);
  const glm::vec3 towards_sun(light.towards_sun);
  const physics::SkyLight sky = physics::SkyLightOf(towards_sun);
  const auto irradiance = static_cast<float>(scene.sun.irradiance);
  light.sunlight = irradiance * physics::glsl::sun_transmittance(towards_sun.z);
  const glm::vec3 from_sky =
      sky.mean_radiance * irradiance * static_cast<float>(scene.sky.brightness);
  light.ambient = 0.5F * (from_sky + GroundRadiance(scene, towards_sun, sky));
  return light;
}

glm::ivec2 EyeSize(const scene::Scene& scene, const DrawQuality& quality) {
  const glm::dvec2 size(scene.output.width_px, scene.output.height_px);
  return glm::max(glm::ivec2(glm::ceil(size * quality.image_scale)), glm::ivec2(1));
}

}  // namespace

SceneRenderer::SceneRenderer(std::shared_ptr<gl::ProgramCache> programs)
    : programs_(std::move(programs)), half_angle_(programs_), light_volume_(programs_) {}

scene::Stage SceneRenderer::FirstStage(
    const scene::Scene& scene,
    const std::shared_ptr<const volume::HydrometeorFields>& fields) const {
  if (!drawn_scene_.has_value() || drawn_fields_.lock() != fields) return scene::Stage::kStorm;
  return scene::FirstDirtyStage(*drawn_scene_, scene);
}

std::size_t SceneRenderer::Bytes() const {
  return medium_.Bytes() + half_angle_.Bytes() + light_volume_.Bytes() + linear_.Bytes();
}

absl::StatusOr<LinearFrame> SceneRenderer::Draw(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
    const DrawQuality& quality) {
  scene::Stage first = FirstStage(scene, fields);
  if (quality != drawn_quality_) first = std::min(first, scene::Stage::kView);
  drawn_scene_.reset();
  std::vector<StageTime> stages;
  if (first <= scene::Stage::kExtinction) {
    ResidentMedium::Cost cost;
    medium_ = ResidentMedium();
    medium_ = ResidentMedium(scene, *fields, &detail_noises_, &cost);
    stages.push_back({"extinction", cost.extinction_ms});
    stages.push_back({"upload", cost.upload_ms});
  }
  if (first <= scene::Stage::kView) {
    const scene::View view = scene::ViewOf(scene, *fields);
    drawn_slices_ = 0;
    if (!medium_.Empty()) {
      const double wanted = std::ceil(scene.rendering.slices * quality.slice_share);
      drawn_slices_ = std::max(static_cast<int>(wanted), 1);
      THUNDERHEAD_RETURN_IF_ERROR(DrawMedium(
          {scene.rendering, view, IlluminationOf(scene), EyeSize(scene, quality), drawn_slices_},
          first, &stages));
    }
    base::Stopwatch stopwatch;
    THUNDERHEAD_RETURN_IF_ERROR(Composite(scene, view, volume::LowestTerrain_m(*fields)));
    glFinish();
    stages.push_back({"composite", stopwatch.ElapsedMs()});
  }
  drawn_scene_ = scene;
  drawn_fields_ = fields;
  drawn_quality_ = quality;
  LinearFrame frame = Report(*fields);
  frame.stages = std::move(stages);
  return frame;
}

absl::Status SceneRenderer::DrawMedium(const RenderSettings& settings, scene::Stage first,
                                       std::vector<StageTime>* stages) {
  base::Stopwatch stopwatch;
  const auto ran = [&](const char* stage) {
    glFinish();
    stages->push_back({stage, stopwatch.Restart()});
  };
  const bool light_changed = first <= scene::Stage::kLight;
  switch (settings.rendering.renderer) {
    case scene::Renderer::kHalfAngle:
      THUNDERHEAD_RETURN_IF_ERROR(half_angle_.Render(medium_, settings, light_changed));
      ran("slices");
      break;
    case scene::Renderer::kLightVolume:
      if (light_changed) {
        THUNDERHEAD_RETURN_IF_ERROR(light_volume_.CarryLight(medium_, settings));
        ran("light");
      }
      THUNDERHEAD_RETURN_IF_ERROR(light_volume_.DrawView(medium_, settings));
      ran("view");
      break;
  }
  drawn_by_ = settings.rendering.renderer;
  return absl::OkStatus();
}

const gl::Texture2D& SceneRenderer::Eye() const {
  if (medium_.Empty()) return nothing_;
  return drawn_by_ == scene::Renderer::kHalfAngle ? half_angle_.Eye() : light_volume_.Eye();
}

absl::Status SceneRenderer::Composite(const scene::Scene& scene, const scene::View& view,
                                      double ground_height_m) {
  const glm::ivec2 size(scene.output.width_px, scene.output.height_px);
  if (linear_.Size() != size) {
    linear_ = gl::Texture2D(GL_RGBA16F, size);
    linear_target_ = gl::Framebuffer(linear_);
  }
  if (nothing_.Get() == 0) {
    nothing_ = gl::Texture2D(GL_RGBA16F, glm::ivec2(1));
    gl::Framebuffer(nothing_).Clear(0.0F, 0.0F, 0.0F, 1.0F);
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get({"common/whole_target.vert", "post/composite.frag", {}}));
  const glm::vec3 towards_sun(scene::Direction(scene.sun.azimuth_deg, scene.sun.elevation_deg));
  BindLocalRays(*program, view);
  program->Set("towards_sun", glm::vec3(view.local_from_world * glm::dvec3(towards_sun)));
  program->Set("sky_scale", static_cast<float>(scene.sun.irradiance * scene.sky.brightness));
  program->Set("ground_radiance",
               GroundRadiance(scene, towards_sun, physics::SkyLightOf(towards_sun)));
  program->Set("eye_height_m", static_cast<float>(view.altitude_m - ground_height_m));
  program->Set("ground_curvature_per_m", static_cast<float>(view.ground_curvature_per_m));
  Eye().Bind(kEyeUnit);
  linear_target_.Bind();
  program->Use();
  no_attributes_.Bind();
  glDrawArrays(GL_TRIANGLES, 0, 3);
  return absl::OkStatus();
}

LinearFrame SceneRenderer::Report(const volume::HydrometeorFields& fields) const {
  LinearFrame frame;
  frame.radiance = &linear_;
  frame.fields = medium_.Content().hydrometeors;
  frame.slices = drawn_slices_;
  frame.device_bytes = Bytes();
  if (!medium_.Empty()) {
    const glm::dvec3 box_m = 2.0 * medium_.HalfExtent_m();
    const glm::dvec3 domain_m = fields.grid.HighCorner_m() - fields.grid.low_corner_m;
    const bool leaps = drawn_by_ == scene::Renderer::kLightVolume;
    frame.occupied_share = (leaps ? medium_.OccupiedShare() : 1.0) * box_m.x * box_m.y * box_m.z /
                           (domain_m.x * domain_m.y * domain_m.z);
  }
  return frame;
}

}  // namespace thunderhead::renderers
