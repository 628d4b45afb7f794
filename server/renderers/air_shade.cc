#include "renderers/air_shade.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "physics/sky.h"
#include "renderers/group_weights.h"
#include "renderers/view_uniforms.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

constexpr int kHeights = 64;
constexpr double kHighest_m = 3e4;  // air above this height counts as equally bright

constexpr int kPixelsPerRay = 6;        // pixels per ray along each side
constexpr glm::ivec2 kMinRays(48, 36);  // minimum, except for pictures with fewer pixels
constexpr glm::ivec2 kMaxRays(160, 120);
// Number of distances, each with a layer. One more layer holds the share of the whole sky.
constexpr int kDistances = 25;

// Spacing of the points at which the hidden share of the sky is computed. The share varies slowly.
constexpr double kHiddenSpacing_m = 5000.0;
constexpr glm::ivec3 kMaxHidden(28, 28, 8);
constexpr double kHiddenStepInCells = 2.0;

glm::ivec3 HiddenPoints(const volume::WorldBox& box) {
  const glm::dvec3 size_m = box.high_m - box.low_m;
  // With at least 4 texels along each side, there is room for a border of zeros.
  return glm::clamp(glm::ivec3(glm::ceil(size_m / glm::dvec3(kHiddenSpacing_m, kHiddenSpacing_m,
                                                             0.5 * kHiddenSpacing_m))),
                    glm::ivec3(4), kMaxHidden);
}

}  // namespace

void AirShade::SetLight(const physics::Atmosphere& atmosphere, double sun_sine,
                        const glm::vec3& sky_irradiance) {
  const glm::vec3 sun = atmosphere.SunTransmittance({0.0F, static_cast<float>(sun_sine)});
  level_irradiance_ = sky_irradiance + sun * static_cast<float>(std::max(sun_sine, 0.0));
  level_skylight_ = sky_irradiance;
  const auto at = [&](int i) {
    const double height_m = kHighest_m * i / (kHeights - 1);
    return physics::AirPlace{static_cast<float>(height_m), static_cast<float>(sun_sine)};
  };
  sunlight_.clear();
  for (int i = 0; i < kHeights; ++i) sunlight_.push_back(atmosphere.SunTransmittance(at(i)));
  std::vector<glm::vec3> texels = sunlight_;
  for (int i = 0; i < kHeights; ++i) texels.push_back(atmosphere.DiffuseMeanRadiance(at(i)));
  if (light_.Get() == 0) light_ = gl::Texture2D(GL_RGBA32F, {kHeights, 2});
  light_.Upload(GL_RGB, GL_FLOAT, texels.data());
}

absl::Status AirShade::HideSky(const ResidentMedium& medium, const scene::Scene& scene,
                               double ground_m) {
  if (medium.Empty()) {
    if (hidden_by_ != 0 || sky_hidden_.Get() == 0) {
      sky_hidden_ = gl::Texture3D(GL_RG16F, glm::ivec3(1));
      sky_hidden_.Clear();
      storm_faces_ = gl::Texture3D(GL_RGBA16F, glm::ivec3(1));
      storm_faces_.Clear();
      hidden_box_ = {glm::dvec3(0.0), glm::dvec3(1.0)};
      hidden_by_ = 0;
    }
    return absl::OkStatus();
  }
  const scene::MediumSettings settings = scene::MediumSettingsOrDefault(scene.rendering.technique);
  if (hidden_by_ == medium.Id() && hidden_settings_ == settings) return absl::OkStatus();
  const GroupWeights weights(medium.Content(), settings);
  const volume::WorldBox box{medium.Middle_m() - medium.HalfExtent_m(),
                             medium.Middle_m() + medium.HalfExtent_m()};
  hidden_box_ = scene::ShadedAirOf(box, {0.0, 0.0, 1.0}, ground_m).from_sky;
  const glm::ivec3 points = HiddenPoints(hidden_box_);
  if (sky_hidden_.Size() != points) {
    sky_hidden_ = gl::Texture3D(GL_RG16F, points);
    storm_faces_ = gl::Texture3D(GL_RGBA16F, points);
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::Compute(
          "air/sky_hidden.comp",
          MediumVariant{.groups = medium.Variant().groups, .details = 0}.Defines())));
  medium.BindWithBricks(*program);
  program->Set(uniform::point_count, points);
  program->Set(uniform::lattice_low_m, glm::vec3(hidden_box_.low_m - medium.Middle_m()));
  program->Set(uniform::lattice_size_m, glm::vec3(hidden_box_.high_m - hidden_box_.low_m));
  const glm::dvec3 cell_m = medium.Bounds().grid.spacing_m;
  program->Set(uniform::step_m,
               static_cast<float>(kHiddenStepInCells * std::min({cell_m.x, cell_m.y, cell_m.z})));
  program->Set(uniform::light_weights, medium.Weights(weights.light));
  program->Set(uniform::transport_weights, medium.Weights(weights.transport));
  program->Set(uniform::absorption_weights, medium.Weights(weights.absorption));
  sky_hidden_.BindImage(shaders::kSkyHiddenImage, GL_WRITE_ONLY);
  storm_faces_.BindImage(shaders::kStormFacesImage, GL_WRITE_ONLY);
  program->Use();
  const glm::ivec3 groups = (points + shaders::kLightGroupSide - 1) / shaders::kLightGroupSide;
  glDispatchCompute(static_cast<GLuint>(groups.x), static_cast<GLuint>(groups.y),
                    static_cast<GLuint>(points.z));
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  hidden_by_ = medium.Id();
  hidden_settings_ = settings;
  return programs_->Pieces().Between();
}

void AirShade::SetDistances(const scene::View& view, const scene::ShadedAir& air) {
  const glm::dvec3 low_m = glm::min(air.from_sun.low_m, air.from_sky.low_m) - view.eye_m;
  const glm::dvec3 high_m = glm::max(air.from_sun.high_m, air.from_sky.high_m) - view.eye_m;
  near_m_ = glm::length(glm::max(glm::max(low_m, -high_m), glm::dvec3(0.0)));
  far_m_ = glm::length(glm::max(glm::abs(low_m), glm::abs(high_m)));
  if (!view.Orthographic()) return;
  // Rays are parallel, so depths along the view direction are distances.
  const glm::dvec3 middle_m = 0.5 * (low_m + high_m);
  const double half_m = glm::dot(glm::abs(view.forward), 0.5 * (high_m - low_m));
  near_m_ = std::max(glm::dot(middle_m, view.forward) - half_m, 0.0);
  far_m_ = std::max(glm::dot(middle_m, view.forward) + half_m, near_m_ + 1.0);
}

absl::Status AirShade::Cast(const scene::Scene& scene, const scene::View& view,
                            const Ground& ground, const volume::WorldBox& box,
                            const glm::ivec2& picture_px) {
  const glm::dvec3 towards_sun = scene::Direction(scene.sun.azimuth_deg, scene.sun.elevation_deg);
  SetDistances(view, scene::ShadedAirOf(box, towards_sun, ground.Lowest_m()));
  const double middle_m = 0.5 * (box.low_m.z + box.high_m.z);
  const auto level = std::lround((kHeights - 1) * std::clamp(middle_m / kHighest_m, 0.0, 1.0));
  const glm::vec3 sunlight = sunlight_[static_cast<std::size_t>(level)];
  faces_sunlight_ = static_cast<float>(scene.sun.irradiance) * sunlight;
  const glm::ivec3 size(glm::clamp((picture_px + kPixelsPerRay - 1) / kPixelsPerRay,
                                   glm::min(picture_px, kMinRays), kMaxRays),
                        kDistances + 1);
  if (shade_.Size() != size) shade_ = gl::Texture3D(GL_RGBA16F, size);
  THUNDERHEAD_ASSIGN_OR_RETURN(const gl::Program* program,
                               programs_->Get(gl::ProgramSource::Compute("air/shade.comp")));
  BindRays(*program, view, view.eye_m);
  ground.BindShadow(*program, view);
  BindSkyHidden(*program, view);
  const auto altitude_m = static_cast<float>(std::max(view.altitude_m, 0.0));
  program->Set(uniform::shade_size, size);
  program->Set(uniform::local_from_world, glm::mat3(view.local_from_world));
  program->Set(uniform::towards_sun, glm::vec3(towards_sun));
  program->Set(uniform::horizon_sine,
               physics::HorizonSine(altitude_m, static_cast<float>(ground.Lowest_m())));
  program->Set(uniform::level_irradiance, level_irradiance_);
  program->Set(uniform::level_skylight, level_skylight_);
  program->Set(uniform::faces_sunlight, sunlight);
  program->Set(uniform::turbidity, static_cast<float>(scene.sky.turbidity));
  program->Set(uniform::altitude_m, altitude_m);
  program->Set(uniform::air_densities, physics::glsl::densities_of_air(altitude_m));
  program->Set(uniform::ground_curvature_per_m, static_cast<float>(view.ground_curvature_per_m));
  program->Set(uniform::lowest_air_m, static_cast<float>(ground.Lowest_m()));
  program->Set(uniform::near_m, static_cast<float>(near_m_));
  program->Set(uniform::far_m, static_cast<float>(far_m_));
  program->Set(uniform::air_light_per_m, static_cast<float>(1.0 / kHighest_m));
  light_.Bind(shaders::kAirLightUnit);
  shade_.BindImage(shaders::kAirShadeImage, GL_WRITE_ONLY);
  program->Use();
  const glm::ivec3 groups = (size + shaders::kLightGroupSide - 1) / shaders::kLightGroupSide;
  glDispatchCompute(static_cast<GLuint>(groups.x), static_cast<GLuint>(groups.y), 1);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  present_ = true;
  return programs_->Pieces().Between();
}

void AirShade::BindSkyHidden(const gl::Program& program, const scene::View& view) const {
  const glm::dvec3 size_m = hidden_box_.high_m - hidden_box_.low_m;
  program.Set(uniform::hidden_scale, glm::vec3(1.0 / size_m));
  program.Set(uniform::hidden_offset, glm::vec3((view.eye_m - hidden_box_.low_m) / size_m));
  sky_hidden_.Bind(shaders::kSkyHiddenUnit);
  storm_faces_.Bind(shaders::kStormFacesUnit);
}

void AirShade::Bind(const gl::Program& program, const scene::View& view) const {
  if (!present_) return;
  BindSkyHidden(program, view);
  program.Set(uniform::faces_sunlight, faces_sunlight_);
  program.Set(uniform::shade_near_m, static_cast<float>(near_m_));
  program.Set(uniform::shade_far_m, static_cast<float>(far_m_));
  shade_.Bind(shaders::kAirShadeUnit);
}

}  // namespace thunderhead::renderers
