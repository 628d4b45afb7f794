#include "renderers/sun_glow.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "physics/atmosphere.h"
#include "physics/aureole.h"
#include "renderers/group_weights.h"
#include "renderers/view_uniforms.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

// Guessed costs of a sample of the medium and of a pixel of the sun's disc.
constexpr double kSample_ns = 15.0;
constexpr double kDiscPixel_ns = 200.0;

using physics::Aureole;

// Angle from the sun's centre up to which the disc and its blurred edge are drawn.
constexpr double kDiscReach_rad = 2.0 * physics::kSunRadius_rad;

bool IsDark(const SunGlow::Sun& sun) {
  return std::max({sun.irradiance.r, sun.irradiance.g, sun.irradiance.b}) <= 0.0F;
}

// Returns the angle across a pixel in the picture's middle, at least 1e-5.
double PixelAngle_rad(const scene::View& view, const glm::ivec2& size_px) {
  return std::max(2.0 * view.tan_half_height / size_px.y, 1e-5);
}

gl::Defines ChosenBy(const SunGlow::Picture& picture) {
  return {{"CHOSEN", picture.chosen != nullptr ? 1 : 0}};
}

}  // namespace

PixelRect RectAround(const glm::dvec3& direction, double angle_rad, const scene::View& view,
                     const glm::ivec2& size_px) {
  const PixelRect whole{glm::ivec2(0), size_px};
  if (view.Orthographic()) {
    return glm::dot(view.forward, direction) >= std::cos(angle_rad) ? whole : PixelRect{};
  }
  constexpr int kRim = 64;
  // Smallest forward component of a direction that is projected. The projection is unbounded at the
  // plane through the eye.
  constexpr double kGrazing = 0.02;
  const glm::dvec3 helper =
      std::abs(direction.z) < 0.9 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(1.0, 0.0, 0.0);
  const glm::dvec3 right = glm::normalize(glm::cross(direction, helper));
  const glm::dvec3 up = glm::cross(right, direction);
  glm::dvec2 low(1e9);
  glm::dvec2 high(-1e9);
  double farthest_forward = -1.0;
  double least_forward = 1.0;
  for (int i = 0; i < kRim; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / kRim;
    // The polygon is circumscribed, so that it contains the whole cone.
    const double reach = std::tan(angle_rad) / std::cos(std::numbers::pi / kRim);
    const glm::dvec3 rim =
        glm::normalize(direction + reach * (std::cos(turn) * right + std::sin(turn) * up));
    const double forward = glm::dot(rim, view.forward);
    farthest_forward = std::max(farthest_forward, forward);
    least_forward = std::min(least_forward, forward);
    const glm::dvec2 place(glm::dot(rim, view.right) / view.tan_half_width,
                           glm::dot(rim, view.up) / view.tan_half_height);
    low = glm::min(low, place / std::max(forward, kGrazing));
    high = glm::max(high, place / std::max(forward, kGrazing));
  }
  if (farthest_forward <= 0.0) return {};
  if (least_forward <= kGrazing) return whole;
  const glm::dvec2 half_px = 0.5 * glm::dvec2(size_px);
  return {glm::clamp(glm::ivec2(glm::floor(half_px + low * half_px)), glm::ivec2(0), size_px),
          glm::clamp(glm::ivec2(glm::ceil(half_px + high * half_px)), glm::ivec2(0), size_px)};
}

void SunGlow::Tabulate(const Medium& medium, double cut_rad) {
  std::vector<physics::PhaseFunction> phases;
  for (const MediumGroup& group : medium.groups) phases.push_back(group.phase);
  if (phases == tabulated_ && cut_rad == tabulated_cut_rad_) return;
  std::vector<glm::vec3> texels;
  shares_.clear();
  for (const physics::PhaseFunction& phase : phases) {
    const Aureole aureole = Aureole::Of(phase, cut_rad);
    shares_.push_back(static_cast<float>(aureole.share));
    texels.insert(texels.end(), aureole.radiances.begin(), aureole.radiances.end());
  }
  const glm::ivec3 size(Aureole::kAngles, Aureole::kDepths, static_cast<int>(phases.size()));
  if (table_.Size() != size) table_ = gl::Texture3D(GL_RGBA32F, size);
  table_.Upload(GL_RGB, GL_FLOAT, texels.data());
  tabulated_ = std::move(phases);
  tabulated_cut_rad_ = cut_rad;
}

void SunGlow::BindSun(const gl::Program& program, const Sun& sun, const scene::View& view,
                      const Picture& picture) const {
  program.Set(uniform::towards_sun, glm::vec3(sun.towards));
  program.Set(uniform::sunlight, sun.irradiance);
  program.Set(uniform::pixel_rad, static_cast<float>(PixelAngle_rad(view, picture.size_px)));
}

absl::Status SunGlow::Add(const gl::Program& program, const gl::PieceCost& pixel,
                          const PixelRect& rect, const Picture& picture) {
  if (picture.chosen != nullptr) picture.chosen->Bind();
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  absl::Status added =
      whole_target_.Draw(programs_->Pieces(), pixel, program, picture.target,
                         picture.chosen == nullptr ? rect : picture.chosen->Rect());
  glDisable(GL_BLEND);
  return added;
}

absl::Status SunGlow::AddThrough(const ResidentMedium& medium,
                                 const scene::MediumSettings& settings, int slices, const Sun& sun,
                                 const scene::View& view, Ground* ground, const Picture& picture) {
  if (IsDark(sun)) return absl::OkStatus();
  const GroupWeights weights(medium.Content(), settings);
  // If phase functions are not cut, all scattered light is already drawn and no aureole is added.
  const bool cuts = weights.phase_cut > 0.0F;
  const double cut_rad = cuts ? glm::radians(settings.theta_f_deg) / 2.0 : 0.0;
  const double reach_rad = std::max(2.0 * cut_rad, kDiscReach_rad);
  const PixelRect rect = RectAround(sun.towards, reach_rad, view, picture.size_px);
  if (rect.Empty()) return absl::OkStatus();
  Tabulate(medium.Content(), cut_rad);
  THUNDERHEAD_RETURN_IF_ERROR(ground->DrawDistance(
      view, picture.chosen == nullptr ? picture.size_px : picture.chosen->Size(), picture.chosen));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::BlendedWholeTarget(
          "sun/aureole.frag", gl::Joined(medium.Variant().Defines(), ChosenBy(picture)))));
  medium.BindWithBricks(*program);
  weights.BindPhase(*program);
  BindRays(*program, view, medium.Middle_m());
  medium.BindPixel(*program, view, picture.size_px);
  BindSun(*program, sun, view, picture);
  const double depth_m = 2.0 * glm::dot(glm::abs(view.forward), medium.HalfExtent_m());
  program->Set(uniform::step_m, static_cast<float>(depth_m / slices));
  const std::vector<double> whole(medium.Content().groups.size(), 1.0);
  program->Set(uniform::extinction_weights, medium.Weights(whole));
  program->Set(uniform::scattering_weights, medium.Weights(weights.scattering));
  program->Set(uniform::peak_share, shares_);
  program->Set(uniform::aureole_end_rad, static_cast<float>(reach_rad));
  program->Set(uniform::aureole_max_depth, static_cast<float>(Aureole::kMaxDepth));
  table_.Bind(shaders::kAureoleUnit);
  ground->Distance().Bind(shaders::kGroundDistanceUnit);
  return Add(*program, {"aureole", kSample_ns * slices}, rect, picture);
}

absl::Status SunGlow::AddBehind(const gl::Texture2D& eye, const Sun& sun, const scene::View& view,
                                const Ground& ground, const Picture& picture) {
  if (IsDark(sun)) return absl::OkStatus();
  const PixelRect rect = RectAround(sun.towards, kDiscReach_rad, view, picture.size_px);
  if (rect.Empty()) return absl::OkStatus();
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::BlendedWholeTarget(
          "sun/disc.frag", gl::Joined(ground.Variant().Defines(), ChosenBy(picture)))));
  BindRays(*program, view, view.eye_m);
  ground.Bind(*program, view);
  BindSun(*program, sun, view, picture);
  eye.Bind(shaders::kEyeUnit);
  return Add(*program, {"sun's disc", kDiscPixel_ns}, rect, picture);
}

}  // namespace thunderhead::renderers
