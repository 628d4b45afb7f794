#include "renderers/ground.h"

#include <algorithm>
#include <cmath>

#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "renderers/group_weights.h"
#include "renderers/view_uniforms.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

// Maximum number of texels along the longer side of the shadow map.
constexpr int kMaxShadowTexels = 192;
constexpr double kShadowTexelInCells = 1.0;  // minimum size of a texel
constexpr double kShadowStepInCells = 1.0;   // distance between samples along the sun's rays
constexpr double kLevel_m = 1.0;  // terrain with smaller height differences counts as level

constexpr gl::PieceCost kShadowTexel{"ground shadow", 2000.0};
constexpr gl::PieceCost kDistancePixel{"ground distance", 100.0};

// Returns an upper limit of the terrain's slope. It combines the largest slopes between
// neighbouring grid columns along x and along y.
double SteepestSlope(const volume::RegularGrid& grid, const std::vector<float>& height_m) {
  double steepest_x = 0.0;
  double steepest_y = 0.0;
  for (int y = 0; y < grid.cells.y; ++y) {
    for (int x = 0; x < grid.cells.x; ++x) {
      const double here = height_m[grid.Offset(x, y, 0)];
      if (x > 0) {
        steepest_x = std::max(steepest_x, std::abs(here - height_m[grid.Offset(x - 1, y, 0)]));
      }
      if (y > 0) {
        steepest_y = std::max(steepest_y, std::abs(here - height_m[grid.Offset(x, y - 1, 0)]));
      }
    }
  }
  return std::hypot(steepest_x / grid.spacing_m.x, steepest_y / grid.spacing_m.y);
}

}  // namespace

void Ground::SetTerrain(const volume::HydrometeorFields& fields) {
  grid_ = fields.grid;
  const std::vector<float>& height_m = fields.terrain_height_m;
  relief_ = false;
  lowest_m_ = highest_m_ = grid_.low_corner_m.z;
  if (height_m.empty()) return;
  const auto [lowest, highest] = std::minmax_element(height_m.begin(), height_m.end());
  lowest_m_ = *lowest;
  highest_m_ = *highest;
  relief_ = highest_m_ - lowest_m_ > kLevel_m;
  if (!relief_) return;
  steepest_ = SteepestSlope(grid_, height_m);
  const glm::ivec2 size(grid_.cells);
  if (terrain_.Size() != size) terrain_ = gl::Texture2D(GL_R32F, size);
  terrain_.Upload(GL_RED, GL_FLOAT, height_m.data());
}

absl::Status Ground::CastShadow(const ResidentMedium& medium, const RenderSettings& settings) {
  has_shadow_ = false;
  const glm::dvec3& towards_sun = settings.illumination.towards_sun;
  if (medium.Empty() || towards_sun.z <= 0.0) return absl::OkStatus();
  const LightFrame frame = LightFrameOf({medium.HalfExtent_m()}, towards_sun);
  const glm::dvec3 cell_m = medium.Bounds().grid.spacing_m;
  const double longest_m = 2.0 * std::max(frame.half_extent_m.x, frame.half_extent_m.y);
  const double texel_m =
      std::max(longest_m / kMaxShadowTexels, kShadowTexelInCells * std::min(cell_m.x, cell_m.y));
  const glm::ivec2 size =
      glm::max(glm::ivec2(glm::ceil(2.0 * frame.half_extent_m / texel_m)), glm::ivec2(1));
  if (shadow_.Size() != size) {
    shadow_ = gl::Texture2D(GL_RGBA32F, size, gl::Edge::kZero);
    shadow_target_ = gl::Framebuffer(shadow_);
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const gl::Program* program,
                               programs_->Get(gl::ProgramSource::WholeTarget(
                                   "ground/shadow.frag", medium.Variant().Defines())));
  medium.BindWithBricks(*program);
  const GroupWeights weights(medium.Content(), scene::MediumSettingsOrDefault(settings.technique));
  const glm::dvec3 through_m = cell_m / glm::max(glm::abs(towards_sun), glm::dvec3(1e-6));
  const double step_m = kShadowStepInCells * std::min({through_m.x, through_m.y, through_m.z});
  program->Set(uniform::towards_sun, glm::vec3(towards_sun));
  program->Set(uniform::light_right_m, glm::vec3(frame.right * frame.half_extent_m.x));
  program->Set(uniform::light_up_m, glm::vec3(frame.up * frame.half_extent_m.y));
  program->Set(uniform::light_weights, medium.Weights(weights.light));
  program->Set(uniform::half_depth_m, static_cast<float>(frame.half_depth_m));
  program->Set(uniform::step_m, static_cast<float>(step_m));
  THUNDERHEAD_RETURN_IF_ERROR(
      whole_target_.Draw(programs_->Pieces(), kShadowTexel, *program, shadow_target_));
  PlaceShadow(frame, medium.Middle_m());
  return absl::OkStatus();
}

void Ground::TakeShadow(gl::Texture2D shadow, const LightFrame& frame, const glm::dvec3& middle_m) {
  shadow_ = std::move(shadow);
  shadow_target_ = gl::Framebuffer(shadow_);
  PlaceShadow(frame, middle_m);
}

void Ground::ShareShadow(const gl::Texture2D* shadow, const LightFrame& frame,
                         const glm::dvec3& middle_m) {
  PlaceShadow(frame, middle_m);
  shared_shadow_ = shadow;
}

void Ground::PlaceShadow(const LightFrame& frame, const glm::dvec3& middle_m) {
  shadow_middle_m_ = middle_m;
  shadow_right_ = frame.right / frame.half_extent_m.x;
  shadow_up_ = frame.up / frame.half_extent_m.y;
  shadow_down_ = -frame.towards_sun / frame.half_depth_m;
  shared_shadow_ = nullptr;
  has_shadow_ = true;
}

absl::Status Ground::DrawDistance(const scene::View& view, const glm::ivec2& size,
                                  const ChosenRays* chosen) {
  drawn_distance_ = chosen == nullptr ? 0 : 1;
  Distances& distances = distances_[drawn_distance_];
  if (distances.distance_m.Size() != size) {
    distances.distance_m = gl::Texture2D(GL_R32F, size);
    distances.target = gl::Framebuffer(distances.distance_m);
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::WholeTarget(
          "ground/distance.frag",
          gl::Joined(Variant().Defines(), {{"CHOSEN", chosen != nullptr ? 1 : 0}}))));
  BindRays(*program, view, view.eye_m);
  Bind(*program, view);
  if (chosen == nullptr) {
    return whole_target_.Draw(programs_->Pieces(), kDistancePixel, *program, distances.target);
  }
  chosen->Bind();
  return whole_target_.Draw(programs_->Pieces(), kDistancePixel, *program, distances.target,
                            chosen->Rect());
}

void Ground::Bind(const gl::Program& program, const scene::View& view) const {
  program.Set(uniform::lowest_ground_m, static_cast<float>(lowest_m_ - view.eye_m.z));
  program.Set(uniform::ground_curvature_per_m, static_cast<float>(view.ground_curvature_per_m));
  program.Set(uniform::touch_m, glm::vec2(view.touch_m - glm::dvec2(view.eye_m)));
  if (!relief_) return;
  const glm::dvec2 size_m = glm::dvec2(grid_.cells) * glm::dvec2(grid_.spacing_m);
  const glm::dvec2 low_m = glm::dvec2(grid_.low_corner_m) - glm::dvec2(view.eye_m);
  program.Set(uniform::terrain_from_ground_scale, glm::vec2(1.0 / size_m));
  program.Set(uniform::terrain_from_ground_offset, glm::vec2(-low_m / size_m));
  program.Set(uniform::terrain_offset_m, static_cast<float>(-view.eye_m.z));
  program.Set(uniform::highest_ground_m, static_cast<float>(highest_m_ - view.eye_m.z));
  program.Set(uniform::steepest_ground, static_cast<float>(steepest_));
  terrain_.Bind(shaders::kTerrainUnit);
}

void Ground::SetCorrection(const std::shared_ptr<const LightCorrection>& correction) {
  if (correction != nullptr && correction != correction_) {
    if (skylight_factor_.Size() != correction->ground_size) {
      skylight_factor_ = gl::Texture2D(GL_RGBA16F, correction->ground_size);
    }
    skylight_factor_.Upload(GL_RGBA, GL_FLOAT, correction->ground.data());
  }
  correction_ = correction;
}

void Ground::BindCorrection(const gl::Program& program, const scene::View& view) const {
  if (!Corrected()) return;
  const glm::dvec2 size_m = correction_->ground_high_m - correction_->ground_low_m;
  program.Set(uniform::skylight_scale, glm::vec2(1.0 / size_m));
  program.Set(uniform::skylight_offset,
              glm::vec2((glm::dvec2(view.eye_m) - correction_->ground_low_m) / size_m));
  skylight_factor_.Bind(shaders::kSkylightFactorUnit);
}

void Ground::BindShadow(const gl::Program& program, const scene::View& view) const {
  if (!has_shadow_) {
    // This offset lies far outside the shadow texture, where nothing is shaded.
    program.Set(uniform::shadow_right, glm::vec3(0.0F));
    program.Set(uniform::shadow_up, glm::vec3(0.0F));
    program.Set(uniform::shadow_down, glm::vec3(0.0F));
    program.Set(uniform::shadow_offset, glm::vec3(-9.0F));
    shadow_.Bind(shaders::kGroundShadowUnit);
    return;
  }
  const glm::dvec3 from_eye_m = shadow_middle_m_ - view.eye_m;
  program.Set(uniform::shadow_right, glm::vec3(0.5 * shadow_right_));
  program.Set(uniform::shadow_up, glm::vec3(0.5 * shadow_up_));
  program.Set(uniform::shadow_down, glm::vec3(shadow_down_));
  program.Set(uniform::shadow_offset, glm::vec3(0.5 - 0.5 * glm::dot(from_eye_m, shadow_right_),
                                                0.5 - 0.5 * glm::dot(from_eye_m, shadow_up_),
                                                -glm::dot(from_eye_m, shadow_down_)));
  (shared_shadow_ != nullptr ? *shared_shadow_ : shadow_).Bind(shaders::kGroundShadowUnit);
}

}  // namespace thunderhead::renderers
