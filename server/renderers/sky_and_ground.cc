#include "renderers/sky_and_ground.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/status.h"
#include "glm/geometric.hpp"
#include "physics/optics.h"
#include "renderers/light_map.h"
#include "renderers/view_uniforms.h"
#include "scene/ground.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

// Steps of the eye heights for which sky tables are computed, so that a moving camera rarely needs
// a new table. The heights are about 160 m apart near the ground and 6 % apart far above it. Tables
// are interpolated between two heights.
constexpr double kSkyStep_m = 2500.0;
constexpr double kSkySteps = 16.0;
constexpr std::size_t kMaxTables = 32;

constexpr gl::PieceCost kCompositePixel{"composite", 500.0};

// Preprocessor variant of post/composite.frag.
struct CompositeVariant {
  GroundVariant ground;
  GroundCoverVariant ground_cover;
  gl::DefineValue corrected;  // 1 if renderers::LightCorrection corrects the ground's skylight
  gl::DefineValue shaded;     // 1 if AirShade shades air and skylight
  gl::DefineValue front;      // 1 if the eye buffer may contain something
  gl::DefineValue distances;  // 1 if the distances of the eye buffer's content are known
  gl::DefineValue chosen;     // 1 to draw the rays of ChosenRays

  gl::Defines Defines() const {
    return gl::Joined(gl::Joined(ground.Defines(), ground_cover.Defines()),
                      {{"CORRECTED", corrected},
                       {"SHADED", shaded},
                       {"FRONT", front},
                       {"DISTANCES", distances},
                       {"CHOSEN", chosen}});
  }
};

// Returns the ground's mean radiance divided by the irradiance of level ground.
glm::vec3 GroundReflectance(const scene::Scene& scene) {
  return scene::PlainReflectance(scene) * std::numbers::inv_pi_v<float>;
}

double HeightOfStep(int step) { return kSkyStep_m * std::expm1(step / kSkySteps); }

}  // namespace

void SkyAndGround::Update(const scene::Scene& scene, const scene::View& view,
                          const Ground& ground) {
  towards_sun_ = scene::Direction(scene.sun.azimuth_deg, scene.sun.elevation_deg);
  // Sums over directions always assume a sun in the east. They therefore do not depend on the
  // azimuth of earlier scenes.
  const auto sine = static_cast<float>(towards_sun_.z);
  const glm::vec3 eastern_sun(std::sqrt(std::max(1.0F - sine * sine, 0.0F)), 0.0F, sine);
  const Key key{towards_sun_.z, scene.sky.turbidity, scene.sky.ground_albedo, ground.Lowest_m()};
  if (!sky_.has_value() || key != drawn_) {
    if (!atmosphere_.has_value() || key.turbidity != drawn_.turbidity ||
        key.ground_albedo != drawn_.ground_albedo) {
      atmosphere_.emplace(static_cast<float>(key.turbidity), static_cast<float>(key.ground_albedo));
    }
    const auto ground_m = static_cast<float>(key.ground_m);
    sky_.emplace(*atmosphere_, eastern_sun, physics::ClearSky::Site{ground_m, ground_m});
    sky_light_ = sky_->Light();
    drawn_ = key;
    air_shade_.SetLight(*atmosphere_, towards_sun_.z, sky_light_.irradiance);
    around_sun_.reset();
    eye_height_m_ = -1.0;
    ground_sky_is_new_ = true;
    tables_.clear();
  }
  // around_sun_ is needed only for diffusion transport.
  const scene::MediumSettings* medium = scene::MediumSettingsOf(scene.rendering.technique);
  const bool diffuses = medium != nullptr && medium->transport == scene::Transport::kDiffusion;
  if (diffuses && !around_sun_.has_value()) {
    sky_->TurnTo(eastern_sun);
    around_sun_ = AroundSun(eastern_sun);
  }
  sky_->TurnTo(glm::vec3(towards_sun_));
  SetEyeSky(view.altitude_m);
}

void SkyAndGround::SetEyeSky(double altitude_m) {
  const double wanted_m = std::max(altitude_m - drawn_.ground_m, 0.0);
  if (wanted_m == eye_height_m_) return;
  eye_height_m_ = wanted_m;
  if (sky_table_.Get() == 0) {
    sky_table_ =
        gl::Texture2D(GL_RGBA32F, {2 * physics::glsl::kSkyAzimuths, physics::glsl::kSkyElevations});
  }
  const int below = static_cast<int>(std::floor(kSkySteps * std::log1p(wanted_m / kSkyStep_m)));
  const double low_m = HeightOfStep(below);
  const auto above = static_cast<float>((wanted_m - low_m) / (HeightOfStep(below + 1) - low_m));
  std::vector<glm::vec4> table = TableOfStep(below);
  if (above > 0.0F) {
    const std::vector<glm::vec4>& next = TableOfStep(below + 1);
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = glm::mix(table[i], next[i], above);
  }
  sky_table_.Upload(GL_RGBA, GL_FLOAT, table.data());
}

void SkyAndGround::BindGroundSky() {
  if (ground_sky_table_.Get() == 0) {
    ground_sky_table_ =
        gl::Texture2D(GL_RGBA32F, {2 * physics::glsl::kSkyAzimuths, physics::glsl::kSkyElevations});
  }
  if (ground_sky_is_new_) ground_sky_table_.Upload(GL_RGBA, GL_FLOAT, sky_->Table().data());
  ground_sky_is_new_ = false;
  ground_sky_table_.Bind(shaders::kGroundSkyUnit);
}

const std::vector<glm::vec4>& SkyAndGround::TableOfStep(int step) {
  if (step == 0) return sky_->Table();
  const auto found = tables_.find(step);
  if (found != tables_.end()) return found->second;
  if (tables_.size() >= kMaxTables) tables_.clear();
  const auto ground_m = static_cast<float>(drawn_.ground_m);
  const auto height_m = static_cast<float>(HeightOfStep(step));
  const physics::ClearSky seen(*atmosphere_, glm::vec3(towards_sun_),
                               {ground_m + height_m, ground_m});
  return tables_.emplace(step, seen.Table()).first->second;
}

// Splits skylight into a beam from the sun's direction and the rest of the sky. The beam has the
// irradiance x, and the rest the radiance a + b (1 - sine of the elevation). A surface that faces
// the sun receives as much light from both parts as from the sky. Let I be the irradiance of the
// rest from above over pi, and M its mean radiance. Then a = 3 I - 2 M and b = 6 (M - I). Returns
// x.
glm::vec3 SkyAndGround::AroundSun(const glm::vec3& sun) const {
  constexpr int kElevations = 24;
  constexpr int kAzimuths = 48;
  constexpr float kPi = std::numbers::pi_v<float>;
  constexpr float kSolidAngle = 2.0F * kPi / (kElevations * kAzimuths);
  if (sun.z <= 0.0F) return glm::vec3(0.0F);
  glm::vec3 facing(0.0F);
  // Irradiances on a surface that faces the sun: by a sky of radiance 1, and by one of radiance
  // 1 - sine of the elevation.
  float even = 0.0F;
  float falling = 0.0F;
  for (int i = 0; i < kElevations; ++i) {
    const float sine = (static_cast<float>(i) + 0.5F) / kElevations;
    const float cosine = std::sqrt(1.0F - sine * sine);
    for (int j = 0; j < kAzimuths; ++j) {
      const float azimuth = 2.0F * kPi * (static_cast<float>(j) + 0.5F) / kAzimuths;
      const glm::vec3 direction(cosine * std::cos(azimuth), cosine * std::sin(azimuth), sine);
      const float turned = std::max(glm::dot(direction, sun), 0.0F) * kSolidAngle;
      facing += sky_->At(direction).radiance * turned;
      even += turned;
      falling += (1.0F - sine) * turned;
    }
  }
  const glm::vec3 level = sky_light_.irradiance / kPi;
  const glm::vec3 mean = sky_light_.mean_radiance;
  const glm::vec3 without = (3.0F * level - 2.0F * mean) * even + 6.0F * (mean - level) * falling;
  const float per_x = 1.0F + ((1.0F - 3.0F * sun.z) * even + (6.0F * sun.z - 3.0F) * falling) / kPi;
  // The upper limit keeps the radiance of the rest of the sky above 0 everywhere.
  const glm::vec3 most = glm::min(kPi * mean, 0.5F * kPi * level / sun.z);
  return glm::clamp((facing - without) / std::max(per_x, 0.1F), glm::vec3(0.0F), most);
}

SunGlow::Sun SkyAndGround::SunFrom(const scene::Scene& scene, const scene::View& view) const {
  const auto altitude_m = static_cast<float>(std::max(view.altitude_m, 0.0));
  const auto sine = static_cast<float>((view.local_from_world * towards_sun_).z);
  return {towards_sun_, static_cast<float>(scene.sun.irradiance) *
                            atmosphere_->SunTransmittance({altitude_m, sine})};
}

Illumination SkyAndGround::IlluminationOf(const scene::Scene& scene) const {
  Illumination light;
  light.towards_sun = towards_sun_;
  const auto irradiance = static_cast<float>(scene.sun.irradiance);
  light.sunlight = irradiance * sky_->SunTransmittance();
  for (int i = 0; i < shaders::kSunlightLevels; ++i) {
    const float height_m = static_cast<float>(i) * shaders::kSunlightStep_m;
    light.sunlight_levels.push_back(
        irradiance * atmosphere_->SunTransmittance({height_m, static_cast<float>(towards_sun_.z)}));
  }
  light.from_sky = sky_light_.mean_radiance * irradiance * static_cast<float>(scene.sky.brightness);
  // from_ground is the ground's light without the storm's shadow. Renderers that can show this
  // shadow add it by LitGround.
  const float sine = std::max(static_cast<float>(towards_sun_.z), 0.0F);
  const glm::vec3 diffuse =
      sky_light_.irradiance * irradiance * static_cast<float>(scene.sky.brightness);
  constexpr float kInversePi = std::numbers::inv_pi_v<float>;
  light.around_sun =
      irradiance * static_cast<float>(scene.sky.brightness) * around_sun_.value_or(glm::vec3(0.0F));
  light.rest_of_sky = light.from_sky - light.around_sun * (0.5F * kInversePi);
  light.rest_of_sky_level = (diffuse - light.around_sun * sine) * kInversePi;
  const glm::vec3 received = light.sunlight * sine + diffuse;
  light.from_ground = GroundReflectance(scene) * received;
  light.ground_albedo =
      static_cast<float>(glm::dot(glm::dvec3(scene::PlainReflectance(scene)), physics::kLuminance));
  const double luminance = glm::dot(glm::dvec3(received), physics::kLuminance);
  const double sunlit = glm::dot(glm::dvec3(light.sunlight * sine), physics::kLuminance);
  light.ground_sunlit = static_cast<float>(sunlit / std::max(luminance, 1e-30));
  light.ambient = 0.5F * (light.from_sky + light.from_ground);
  for (const scene::DirectionalLight& lamp : scene.lights) {
    light.beams.push_back({scene::Direction(lamp.azimuth_deg, lamp.elevation_deg),
                           glm::vec3(lamp.irradiance * lamp.color)});
  }
  return light;
}

std::vector<glm::vec3> SkyAndGround::LightMap(const scene::Scene& scene) const {
  const auto sky_scale = static_cast<float>(scene.sun.irradiance * scene.sky.brightness);
  const glm::vec3 from_ground = IlluminationOf(scene).from_ground;
  return LightMapOf([&](const glm::vec3& direction) {
    return direction.z > 0.0F ? sky_scale * sky_->At(direction).radiance : from_ground;
  });
}

void SkyAndGround::BindAir(const gl::Program& program, const scene::Scene& scene,
                           const scene::View& view, const Ground& ground,
                           const volume::WorldBox& box) const {
  BindRays(program, view, view.eye_m);
  ground.Bind(program, view);
  ground.BindShadow(program, view);
  ground.BindCorrection(program, view);
  air_shade_.Bind(program, view);
  const auto irradiance = static_cast<float>(scene.sun.irradiance);
  const auto sky_scale = irradiance * static_cast<float>(scene.sky.brightness);
  const auto altitude_m = static_cast<float>(std::max(view.altitude_m, 0.0));
  program.Set(uniform::local_from_world, glm::mat3(view.local_from_world));
  program.Set(uniform::towards_sun, glm::vec3(towards_sun_));
  program.Set(uniform::towards_sun_local, glm::vec3(view.local_from_world * towards_sun_));
  // The horizon is that of the actual eye height, not of the height for which the table was
  // computed.
  program.Set(uniform::horizon_sine,
              physics::HorizonSine(altitude_m, static_cast<float>(drawn_.ground_m)));
  program.Set(uniform::sky_scale, sky_scale);
  program.Set(uniform::turbidity, static_cast<float>(scene.sky.turbidity));
  program.Set(uniform::altitude_m, altitude_m);
  program.Set(uniform::air_densities, physics::glsl::densities_of_air(altitude_m));
  program.Set(uniform::sunlight, irradiance * sky_->SunTransmittance());
  program.Set(uniform::skylight, sky_scale * sky_light_.irradiance);
  program.Set(uniform::box_low_m, glm::vec3(box.low_m - view.eye_m));
  program.Set(uniform::box_high_m, glm::vec3(box.high_m - view.eye_m));
}

absl::Status SkyAndGround::ShadeAir(const scene::Scene& scene, const scene::View& view,
                                    const Ground& ground, const volume::WorldBox& box,
                                    const ResidentMedium& medium, const glm::ivec2& size_px) {
  THUNDERHEAD_RETURN_IF_ERROR(HideSky(scene, ground, medium));
  return air_shade_.Cast(scene, view, ground, box, size_px);
}

absl::Status SkyAndGround::Composite(const scene::Scene& scene, const scene::View& view,
                                     const Ground& ground, const GroundCover& ground_cover,
                                     const Front& front, const CoveredTarget& target,
                                     const Cover* cover, const ChosenRays* chosen) {
  front.eye.Bind(shaders::kEyeUnit);
  if (front.distances_m != nullptr) front.distances_m->Bind(shaders::kEyeDistanceUnit);
  sky_table_.Bind(shaders::kSkyTableUnit);
  if (scene.ground.cover == scene::GroundCover::kLandUse) BindGroundSky();
  const auto draw = [&](Where where) -> absl::Status {
    const CompositeVariant variant{
        .ground = ground.Variant(),
        .ground_cover = ground_cover.Variant(),
        .corrected = ground.Corrected(),
        .shaded = air_shade_.Present(),
        .front = where == Where::kCovered,
        .distances = where == Where::kCovered && front.distances_m != nullptr,
        .chosen = chosen != nullptr};
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const gl::Program* program,
        programs_->Get(gl::ProgramSource::WholeTarget("post/composite.frag", variant.Defines())));
    BindAir(*program, scene, view, ground, front.box);
    ground_cover.Bind(*program, scene, view, scene.output.height_px);
    const LimitedTo limited(where, cover);
    if (chosen == nullptr) {
      return whole_target_.Draw(programs_->Pieces(), kCompositePixel, *program, target.Target());
    }
    chosen->Bind();
    return whole_target_.Draw(programs_->Pieces(), kCompositePixel, *program, target.Target(),
                              chosen->Rect());
  };
  THUNDERHEAD_RETURN_IF_ERROR(draw(Where::kCovered));
  return cover == nullptr ? absl::OkStatus() : draw(Where::kElsewhere);
}

}  // namespace thunderhead::renderers
