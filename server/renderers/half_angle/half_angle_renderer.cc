#include "renderers/half_angle/half_angle_renderer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/status.h"
#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "renderers/group_weights.h"
#include "renderers/half_angle/bindings.h"
#include "renderers/half_angle/buffer_ring.h"
#include "renderers/half_angle/slice_reach.h"
#include "renderers/half_angle/variants.h"
#include "renderers/view_uniforms.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

// Maximum number of texels along the longer side of the light buffer.
constexpr int kMaxBufferTexels = 256;
constexpr double kBufferTexelInCells = 0.75;  // minimum size of a light texel
constexpr int kThicknessSlices = 128;         // number of slices in SumThickness
// Number of slices that one pass adds to the picture. With a larger slab, render targets change
// less often, but the slab's light takes more memory.
constexpr int kSlabSlices = 16;
constexpr gl::PieceCost kSlabPixel{"slab", 15.0 * kSlabSlices};
// Path length of the light between two exchanges of light with neighbouring texels, in lengths of
// the longest side of a cell (not with the transports of the paper).
constexpr double kExchangeInReach = 3.0;

// Runs the current compute program for each texel of a rectangle.
void Dispatch(const glm::ivec2& size) {
  const glm::ivec2 groups = (size + shaders::kLightGroupSide - 1) / shaders::kLightGroupSide;
  glDispatchCompute(static_cast<GLuint>(groups.x), static_cast<GLuint>(groups.y), 1);
}

// Sets the uniforms of half_angle/slice_light.glsl.
void BindSunRays(const gl::Program& program, const Slicing& slicing, const LightFrame& frame) {
  program.Set(uniform::towards_sun, glm::vec3(frame.towards_sun));
  program.Set(uniform::slice_normal, glm::vec3(slicing.normal));
  program.Set(uniform::first_plane_m, static_cast<float>(slicing.first_m));
  program.Set(uniform::light_path_m, static_cast<float>(slicing.light_path_m));
  program.Set(uniform::light_right_m, glm::vec3(frame.right * frame.half_extent_m.x));
  program.Set(uniform::light_up_m, glm::vec3(frame.up * frame.half_extent_m.y));
}

}  // namespace

// Slices from `begin` to before `end`.
struct HalfAngleRenderer::Slab {
  std::size_t begin = 0;
  std::size_t end = 0;
};

struct HalfAngleRenderer::CarriedLight {
  BufferRing layers;
  // True if light scattered in one dispatch reaches the neighbouring texels only in the next
  // dispatch.
  bool exchanges_late = false;
  PixelRect due{};  // rectangle of texels in which this exchange is pending
};

struct HalfAngleRenderer::Programs {
  const gl::Program* eye;
  const gl::Program* light;
};

HalfAngleRenderer::HalfAngleRenderer(std::shared_ptr<gl::ProgramCache> programs)
    : programs_(std::move(programs)) {}

std::size_t HalfAngleRenderer::Bytes() const {
  return 2 * Eye().Bytes() + light_.Bytes() + thickness_.Bytes() + ring_depth_.Bytes();
}

void HalfAngleRenderer::Resize(const LightFrame& frame, double cell_m) {
  // Texels much finer than cells would add no detail, so kBufferTexelInCells limits them.
  const double longest_m = 2.0 * std::max(frame.half_extent_m.x, frame.half_extent_m.y);
  const double texel_m = std::max(longest_m / kMaxBufferTexels, kBufferTexelInCells * cell_m);
  const glm::ivec2 light_size =
      glm::max(glm::ivec2(glm::ceil(2.0 * frame.half_extent_m / texel_m)), glm::ivec2(1));
  // The image stores of the last frame must complete before the textures are filled below.
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  if (light_.Size() != light_size) {
    // The layers hold the light that enters each slice of a slab, and the light that leaves the
    // slab.
    light_ = gl::Texture2DArray(GL_RG32F, light_size, kSlabSlices + 1);
    light_reach_ = {glm::ivec2(0), light_size};
    thickness_ = gl::Texture2D(GL_R32F, light_size);
    ring_depth_ = gl::Texture2D(GL_R32F, light_size);
  }
  if (!light_reach_.Empty()) light_.Fill(light_reach_.low, light_reach_.high, 1.0F, 0.0F);
  light_reach_ = PixelRect();
  ring_depth_.Clear();
}

absl::Status HalfAngleRenderer::Render(const ResidentMedium& medium, const RenderSettings& settings,
                                       bool light_changed) {
  const LocalBox box{medium.HalfExtent_m()};
  const LightFrame frame = LightFrameOf(box, settings.illumination.towards_sun);
  const Slicing slicing =
      SliceBox(box, settings.illumination.towards_sun, -settings.view.forward, settings.slices);
  const scene::MediumSettings& carried = settings.Medium();
  const GroupWeights weights(medium.Content(), carried);
  const bool translucent = scene::IsTranslucent(carried.transport);
  const bool consistent = !scene::IsPaper(carried.transport);
  const glm::dvec3 cell_m = medium.Bounds().grid.spacing_m;
  Resize(frame, std::min(cell_m.x, cell_m.y));
  for (CoveredTarget& eye : eye_) {
    eye.Resize(GL_RGBA32F, settings.eye_size, settings.cover, true);
    eye.Target().Clear(0.0F, 0.0F, 0.0F, 1.0F);
    eye.Target().Clear(0.0F, 0.0F, 0.0F, 0.0F, 1);
  }
  if (light_changed && translucent && consistent) {
    THUNDERHEAD_RETURN_IF_ERROR(SumThickness(medium, frame, weights));
  }

  const SliceEyeVariant eye_variant{.medium = medium.Variant(),
                                    .colored = weights.colored,
                                    .even_albedo = weights.even_albedo,
                                    .translucent = translucent,
                                    .consistent = consistent,
                                    .ground = settings.ground_distance != nullptr,
                                    .order = OrderOf(slicing, settings.view)};
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* eye,
      programs_->Get(gl::ProgramSource::WholeTarget("half_angle/eye.frag", eye_variant.Defines())));
  medium.BindWithBricks(*eye);
  BindRays(*eye, settings.view, medium.Middle_m());
  medium.BindPixel(*eye, settings.view, settings.eye_size);
  eye->Set(uniform::towards_sun, glm::vec3(frame.towards_sun));
  eye->Set(uniform::slice_normal, glm::vec3(slicing.normal));
  eye->Set(uniform::first_plane_m, static_cast<float>(slicing.first_m));
  eye->Set(uniform::spacing_m, static_cast<float>(slicing.spacing_m));
  eye->Set(uniform::light_path_m, static_cast<float>(slicing.light_path_m));
  eye->Set(uniform::eye_weights, medium.Weights(weights.eye));
  eye->Set(uniform::light_weights, medium.Weights(weights.light));
  eye->Set(uniform::transport_weights, medium.Weights(weights.transport));
  weights.BindScattered(*eye, medium, settings.illumination);
  eye->Set(uniform::light_u, glm::vec3(0.5 * frame.right / frame.half_extent_m.x));
  eye->Set(uniform::light_v, glm::vec3(0.5 * frame.up / frame.half_extent_m.y));

  const SliceLightVariant light_variant{
      .medium = medium.Variant(), .consistent = consistent, .translucent = translucent};
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* light,
      programs_->Get(gl::ProgramSource::Compute("half_angle/carry.comp", light_variant.Defines())));
  medium.BindWithBricks(*light);
  // The light is computed for this view only, so its detail fades out as in the eye buffer.
  medium.BindPixel(*light, settings.view, settings.eye_size);
  BindSunRays(*light, slicing, frame);
  light->Set(uniform::light_weights, medium.Weights(weights.light));
  light->Set(uniform::transport_weights, medium.Weights(weights.transport));
  light->Set(uniform::peripheral_weights, medium.Weights(weights.peripheral));
  light->Set(uniform::cumulative_phase, weights.cumulative_phase);
  const double reach_m =
      consistent ? std::max({cell_m.x, cell_m.y, cell_m.z}) : slicing.light_path_m;
  const double tap_m = reach_m * std::tan(glm::radians(carried.theta_f_deg) * 3.0 / 8.0);
  light->Set(uniform::tap_offset, glm::vec2(0.5 * tap_m / frame.half_extent_m));

  std::size_t at_once = kSlabSlices;
  if (translucent) {
    const double exchange_m = consistent ? kExchangeInReach * reach_m : 0.0;
    at_once = std::max(static_cast<std::size_t>(exchange_m / slicing.light_path_m), std::size_t{1});
  }
  return DrawSlabs({eye, light}, settings, at_once,
                   ReachOf(slicing, medium.OccupiedBoxes(), medium.Middle_m(), settings.view,
                           settings.eye_size, frame, light_.Size()));
}

absl::Status HalfAngleRenderer::SumThickness(const ResidentMedium& medium, const LightFrame& frame,
                                             const GroupWeights& weights) {
  // These slices are perpendicular to the sun's rays, so the sum does not depend on the view and
  // can be kept.
  const Slicing slicing =
      SliceBox({medium.HalfExtent_m()}, frame.towards_sun, frame.towards_sun, kThicknessSlices);
  THUNDERHEAD_ASSIGN_OR_RETURN(const gl::Program* program,
                               programs_->Get(gl::ProgramSource::Compute(
                                   "half_angle/thickness.comp", medium.Variant().Defines())));
  medium.BindWithBricks(*program);
  BindSunRays(*program, slicing, frame);
  program->Set(uniform::transport_weights, medium.Weights(weights.transport));
  program->Set(uniform::texel_count, thickness_.Size());
  program->Set(uniform::slice_count, slicing.count);
  thickness_.BindImage(shaders::kSliceThicknessImage, GL_WRITE_ONLY);
  program->Use();
  Dispatch(thickness_.Size());
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  return absl::OkStatus();
}

absl::Status HalfAngleRenderer::DrawSlabs(const Programs& programs, const RenderSettings& settings,
                                          std::size_t at_once,
                                          const std::vector<SliceReach>& reach) {
  light_.Bind(shaders::kSliceLightUnit);
  light_.BindImage(shaders::kLeavingLightImage, GL_WRITE_ONLY);
  ring_depth_.BindImage(shaders::kRingDepthImage, GL_READ_WRITE);
  thickness_.Bind(shaders::kSliceThicknessUnit);
  if (settings.ground_distance != nullptr)
    settings.ground_distance->Bind(shaders::kGroundDistanceUnit);
  const auto meets = [](const SliceReach& slice) { return !slice.light.Empty(); };
  const auto first = std::find_if(reach.begin(), reach.end(), meets) - reach.begin();
  const auto end = reach.rend() - std::find_if(reach.rbegin(), reach.rend(), meets);
  CarriedLight light{BufferRing(static_cast<std::size_t>(light_.Layers())),
                     settings.Medium().transport != scene::Transport::kLowAlbedo &&
                         !scene::IsPaper(settings.Medium().transport)};
  BufferRing eyes(eye_.size());
  std::size_t drawn = 0;
  for (auto begin = static_cast<std::size_t>(first); begin < static_cast<std::size_t>(end);
       begin += kSlabSlices) {
    const Slab slab{begin,
                    std::min<std::size_t>(begin + kSlabSlices, static_cast<std::size_t>(end))};
    CarryThrough(slab, *programs.light, at_once, reach, &light);
    THUNDERHEAD_RETURN_IF_ERROR(programs_->Pieces().Between());
    last_layer_ = light.layers.Of(slab.end);
    PixelRect seen;
    for (std::size_t i = slab.begin; i < slab.end; ++i) seen = Around(seen, reach[i].eye);
    if (seen.Empty()) continue;
    eye_[eyes.Of(drawn)].Texture().Bind(shaders::kEyeBeforeUnit);
    eye_[eyes.Of(drawn)].Distances().Bind(shaders::kDistanceBeforeUnit);
    ++drawn;
    programs.eye->Set(uniform::begin_layer, static_cast<float>(light.layers.Of(slab.begin)));
    const PixelRect rect = eyes.Write(drawn, seen);
    THUNDERHEAD_RETURN_IF_ERROR(
        DrawSlab(slab, *programs.eye, settings.cover, rect, eye_[eyes.Of(drawn)].Target()));
  }
  last_eye_ = eyes.Of(drawn);
  return absl::OkStatus();
}

void HalfAngleRenderer::CarryThrough(const Slab& slab, const gl::Program& program,
                                     std::size_t at_once, const std::vector<SliceReach>& reach,
                                     CarriedLight* light) {
  program.Use();
  // The layers are reused for each slab. The barrier ensures that the pass of the last slab has
  // read them before they are written again.
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  for (std::size_t first = slab.begin; first < slab.end; first += at_once) {
    const std::size_t end = std::min(first + at_once, slab.end);
    PixelRect scatters;
    for (std::size_t i = first; i < end; ++i) scatters = Around(scatters, reach[i].light);
    PixelRect changed = scatters;
    if (light->exchanges_late) changed = Around(scatters, std::exchange(light->due, scatters));
    light_reach_ = Around(light_reach_, changed);
    PixelRect rect;
    for (std::size_t i = first; i < end; ++i) {
      rect = Around(rect, light->layers.Write(i + 1, changed));
    }
    if (rect.Empty()) continue;
    program.Set(uniform::first_texel, rect.low);
    program.Set(uniform::end_texel, rect.high);
    program.Set(uniform::first_slice, static_cast<int>(first));
    program.Set(uniform::slice_count, static_cast<int>(end - first));
    program.Set(uniform::first_layer, static_cast<int>(light->layers.Of(first)));
    Dispatch(rect.high - rect.low);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  }
}

absl::Status HalfAngleRenderer::DrawSlab(const Slab& slab, const gl::Program& eye,
                                         const Cover* cover, const PixelRect& rect,
                                         const gl::Framebuffer& target) {
  eye.Set(uniform::slab_begin, static_cast<float>(slab.begin));
  eye.Set(uniform::slab_end, static_cast<float>(slab.end));
  const LimitedTo limited(Where::kCovered, cover);
  return whole_target_.Draw(programs_->Pieces(), kSlabPixel, eye, target, rect);
}

}  // namespace thunderhead::renderers
