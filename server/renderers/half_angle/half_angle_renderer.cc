#include "renderers/half_angle/half_angle_renderer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/status.h"
#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "renderers/group_weights.h"
#include "renderers/half_angle/slice_reach.h"
#include "renderers/view_uniforms.h"

namespace thunderhead::renderers {
namespace {

constexpr int kMostLightTexels = 256;        // along the longer side of the light buffer
constexpr double kLightTexelInCells = 0.75;  // size of a light texel
constexpr int kThicknessSlices = 128;        // perpendicular to the light
constexpr GLuint kLightUnit = 4;
constexpr GLuint kThicknessUnit = 5;
constexpr GLuint kGroundUnit = 7;

enum LightPass { kCarry = 0, kTransmit = 1, kAddDepth = 2 };

void Scissor(const PixelRect& rect) {
  glScissor(rect.low.x, rect.low.y, rect.high.x - rect.low.x, rect.high.y - rect.low.y);
}

}  // namespace

struct HalfAngleRenderer::Programs {
  const gl::Program* eye;
  const gl::Program* light;
};

HalfAngleRenderer::HalfAngleRenderer(std::shared_ptr<gl::ProgramCache> programs)
    : programs_(std::move(programs)) {}

std::size_t HalfAngleRenderer::Bytes() const {
  return Eye().Bytes() + light_[0].Bytes() + light_[1].Bytes() + thickness_.Bytes();
}

void HalfAngleRenderer::Resize(const LightFrame& frame, double cell_m) {
  // Finer texels than cells would carry no more detail.
  const double longest_m = 2.0 * std::max(frame.half_extent_m.x, frame.half_extent_m.y);
  const double texel_m = std::max(longest_m / kMostLightTexels, kLightTexelInCells * cell_m);
  const glm::ivec2 light_size =
      glm::max(glm::ivec2(glm::ceil(2.0 * frame.half_extent_m / texel_m)), glm::ivec2(1));
  if (light_[0].Size() == light_size) return;
  for (int i = 0; i < 2; ++i) {
    light_[i] = gl::Texture2D(GL_RG32F, light_size);
    light_target_[i] = gl::Framebuffer(light_[i]);
  }
  thickness_ = gl::Texture2D(GL_R32F, light_size);
  thickness_target_ = gl::Framebuffer(thickness_);
}

absl::Status HalfAngleRenderer::Render(const ResidentMedium& medium, const RenderSettings& settings,
                                       bool light_changed) {
  const LocalBox box{medium.HalfExtent_m()};
  const LightFrame frame = LightFrameOf(box, settings.illumination.towards_sun);
  const Slicing slicing =
      SliceBox(box, settings.illumination.towards_sun, -settings.view.forward, settings.slices);
  const scene::Rendering& rendering = settings.rendering;
  const GroupWeights weights(medium.Content(), rendering);
  const bool translucent = IsTranslucent(rendering);
  const bool consistent = IsConsistent(rendering);
  const auto groups = static_cast<int>(medium.Content().groups.size());
  const glm::dvec3 cell_m = medium.Bounds().grid.spacing_m;
  Resize(frame, std::min(cell_m.x, cell_m.y));
  eye_.Resize(GL_RGBA32F, settings.eye_size, settings.cover);
  if (light_changed && translucent && consistent) {
    THUNDERHEAD_RETURN_IF_ERROR(DrawThickness(medium, settings, frame, weights));
  }

  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* eye,
      programs_->Get({"half_angle/slice.vert",
                      "half_angle/eye.frag",
                      {{"GROUPS", groups},
                       {"DETAILS", medium.Details()},
                       {"COLORED", weights.colored ? 1 : 0},
                       {"TRANSLUCENT", translucent ? 1 : 0},
                       {"CONSISTENT", consistent ? 1 : 0},
                       {"GROUND", settings.ground_distance != nullptr ? 1 : 0},
                       {"FRONT_TO_BACK", slicing.front_to_back ? 1 : 0}}}));
  medium.Bind(*eye);
  const glm::dvec3 middle_m = medium.Middle_m();
  eye->Set("clip_from_local", ClipFromLocal(settings.view, middle_m));
  eye->Set("eye_middle_m", glm::vec3(settings.view.eye_m - middle_m));
  eye->Set("eye_local_m", EyeOf(settings.view, middle_m));
  eye->Set("towards_sun", glm::vec3(frame.towards_sun));
  eye->Set("slice_normal", glm::vec3(slicing.normal));
  eye->Set("spacing_m", static_cast<float>(slicing.spacing_m));
  eye->Set("light_path_m", static_cast<float>(slicing.light_path_m));
  eye->Set("eye_weights", medium.Weights(weights.eye));
  eye->Set("light_weights", medium.Weights(weights.light));
  eye->Set("scattering_weights", medium.Weights(weights.scattering));
  eye->Set("transport_weights", medium.Weights(weights.transport));
  weights.BindPhase(*eye);
  eye->Set("sunlight", settings.illumination.sunlight);
  eye->Set("ambient", settings.illumination.ambient);
  eye->Set("light_u", glm::vec3(0.5 * frame.right / frame.half_extent_m.x));
  eye->Set("light_v", glm::vec3(0.5 * frame.up / frame.half_extent_m.y));

  THUNDERHEAD_ASSIGN_OR_RETURN(const gl::Program* light,
                               programs_->Get({"common/whole_target.vert",
                                               "half_angle/light.frag",
                                               {{"GROUPS", groups},
                                                {"DETAILS", medium.Details()},
                                                {"CONSISTENT", consistent ? 1 : 0},
                                                {"PASS", translucent ? kCarry : kTransmit}}}));
  medium.Bind(*light);
  light->Set("slice_normal", glm::vec3(slicing.normal));
  light->Set("light_path_m", static_cast<float>(slicing.light_path_m));
  light->Set("towards_sun", glm::vec3(frame.towards_sun));
  light->Set("light_right_m", glm::vec3(frame.right * frame.half_extent_m.x));
  light->Set("light_up_m", glm::vec3(frame.up * frame.half_extent_m.y));
  light->Set("light_weights", medium.Weights(weights.light));
  light->Set("transport_weights", medium.Weights(weights.transport));
  light->Set("peripheral_weights", medium.Weights(weights.peripheral));
  light->Set("cumulative_phase", weights.cumulative_phase);
  const double reach_m =
      consistent ? std::max({cell_m.x, cell_m.y, cell_m.z}) : slicing.light_path_m;
  const double tap_m = reach_m * std::tan(glm::radians(rendering.theta_f_deg) * 3.0 / 8.0);
  light->Set("tap_offset", glm::vec2(0.5 * tap_m / frame.half_extent_m));

  DrawSlices({eye, light}, settings, slicing,
             ReachOf(slicing, medium.OccupiedBoxes(), middle_m, settings.view, settings.eye_size,
                     frame, light_[0].Size()));
  return absl::OkStatus();
}

absl::Status HalfAngleRenderer::DrawThickness(const ResidentMedium& medium,
                                              const RenderSettings& settings,
                                              const LightFrame& frame,
                                              const GroupWeights& weights) {
  // Slices across the sun's rays, so that the sum does not depend on the view and can be kept.
  const glm::dvec3& towards_sun = settings.illumination.towards_sun;
  const Slicing slicing =
      SliceBox({medium.HalfExtent_m()}, towards_sun, towards_sun, kThicknessSlices);
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get({"common/whole_target.vert",
                      "half_angle/light.frag",
                      {{"GROUPS", static_cast<int>(medium.Content().groups.size())},
                       {"DETAILS", medium.Details()},
                       {"CONSISTENT", 1},
                       {"PASS", kAddDepth}}}));
  medium.Bind(*program);
  program->Set("slice_normal", glm::vec3(slicing.normal));
  program->Set("light_path_m", static_cast<float>(slicing.light_path_m));
  program->Set("towards_sun", glm::vec3(towards_sun));
  program->Set("light_right_m", glm::vec3(frame.right * frame.half_extent_m.x));
  program->Set("light_up_m", glm::vec3(frame.up * frame.half_extent_m.y));
  program->Set("light_weights", medium.Weights(weights.light));
  program->Set("transport_weights", medium.Weights(weights.transport));
  program->Use();
  no_attributes_.Bind();
  thickness_target_.Bind();
  thickness_target_.Clear(0.0F, 0.0F, 0.0F, 0.0F);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glEnable(GL_SCISSOR_TEST);
  const std::vector<SliceReach> reach =
      ReachOf(slicing, medium.OccupiedBoxes(), medium.Middle_m(), settings.view, settings.eye_size,
              frame, thickness_.Size());
  for (std::size_t i = 0; i < reach.size(); ++i) {
    if (reach[i].light.Empty()) continue;
    Scissor(reach[i].light);
    program->Set("slice_distance_m", static_cast<float>(slicing.slices[i].distance_m));
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_BLEND);
  return absl::OkStatus();
}

void HalfAngleRenderer::DrawSlices(const Programs& programs, const RenderSettings& settings,
                                   const Slicing& slicing, const std::vector<SliceReach>& reach) {
  std::vector<glm::vec3> corners;
  for (const Slice& slice : slicing.slices) {
    corners.insert(corners.end(), slice.polygon.begin(), slice.polygon.end());
  }
  const gl::Buffer corner_buffer(std::max<std::size_t>(corners.size(), 1) * sizeof(glm::vec3),
                                 corners.empty() ? nullptr : corners.data(), 0);
  const gl::VertexArray corner_array = gl::VertexArray::OfPositions(corner_buffer);
  const bool carries = IsTranslucent(settings.rendering);

  eye_.Target().Clear(0.0F, 0.0F, 0.0F, 1.0F);
  for (const gl::Framebuffer& target : light_target_) target.Clear(1.0F, 0.0F, 0.0F, 0.0F);
  thickness_.Bind(kThicknessUnit);
  if (settings.ground_distance != nullptr) settings.ground_distance->Bind(kGroundUnit);
  glEnable(GL_DEPTH_CLAMP);
  int current = 0;
  GLint first = 0;
  PixelRect stale;
  glEnable(GL_SCISSOR_TEST);
  for (std::size_t i = 0; i < reach.size(); ++i) {
    const Slice& slice = slicing.slices[i];
    const auto count = static_cast<GLsizei>(slice.polygon.size());
    const GLint start = first;
    first += count;
    if (count == 0 || reach[i].light.Empty()) continue;
    light_[current].Bind(kLightUnit);
    if (!reach[i].eye.Empty()) {
      // The eye buffer keeps radiance in rgb and in alpha the share of what is behind that still
      // shows.
      glEnable(GL_BLEND);
      if (slicing.front_to_back) {
        glBlendFuncSeparate(GL_DST_ALPHA, GL_ONE, GL_ZERO, GL_SRC_ALPHA);
      } else {
        glBlendFuncSeparate(GL_ONE, GL_SRC_ALPHA, GL_ZERO, GL_SRC_ALPHA);
      }
      eye_.Target().Bind();
      programs.eye->Use();
      corner_array.Bind();
      Scissor(reach[i].eye);
      const LimitedTo limited(Where::kCovered, settings.cover);
      glDrawArrays(GL_TRIANGLE_FAN, start, count);
    }

    programs.light->Set("slice_distance_m", static_cast<float>(slice.distance_m));
    programs.light->Use();
    no_attributes_.Bind();
    if (carries) {
      // The other buffer misses what the last slice changed here.
      glDisable(GL_BLEND);
      light_target_[1 - current].Bind();
      Scissor(Around(reach[i].light, stale));
      stale = reach[i].light;
      current = 1 - current;
    } else {
      glEnable(GL_BLEND);
      glBlendFunc(GL_ZERO, GL_SRC_COLOR);
      light_target_[current].Bind();
      Scissor(reach[i].light);
    }
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
  glDisable(GL_SCISSOR_TEST);
  last_light_ = current;
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_CLAMP);
}

}  // namespace thunderhead::renderers
