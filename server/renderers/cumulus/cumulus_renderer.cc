#include "renderers/cumulus/cumulus_renderer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/matrix.hpp"
#include "renderers/cumulus/bindings.h"
#include "renderers/cumulus/variants.h"
#include "renderers/sunlight.h"
#include "renderers/view_uniforms.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

constexpr int kShadowTexels = 1024;  // number of texels along each side of the shadow map
constexpr int kGroundShadowTexels = 256;
// Distance from the shadow map's eye to the sphere around the surface.
constexpr double kBeforeSurface_m = 2.0;
constexpr int kRoughnessOctaves = 4;
// Wavelength of the roughness relative to the radius of the finest bubbles.
constexpr double kRoughnessInFinest = 1.6;
// Minimum corona thickness relative to the finest radius. It prevents a division by zero.
constexpr double kMinCorona = 1e-3;

constexpr gl::PieceCost kResolvePixel{"resolve", 50.0};
constexpr gl::PieceCost kBubbleDepth{"bubble's depth", 1e5};
constexpr gl::PieceCost kBubbleShade{"bubble", 1e6};

// A bubble in the layout of cumulus/bubble.glsl.
struct DeviceBubble {
  glm::vec4 unit_x;
  glm::vec4 unit_y;
  glm::vec4 unit_z;
  glm::vec4 centre_m;
  glm::vec4 outward;
};

DeviceBubble OnDevice(const clouds::Bubble& bubble, const glm::dvec3& middle_m) {
  // The shader needs the rows of the matrix, which are the columns of its transpose.
  const glm::dmat3 rows = glm::transpose(clouds::UnitFromWorld(bubble));
  const glm::dmat3& axes = bubble.semi_axes_m;
  const double longest_m =
      std::max({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
  return {glm::vec4(glm::vec3(rows[0]), static_cast<float>(clouds::RadiusOf(bubble))),
          glm::vec4(glm::vec3(rows[1]), static_cast<float>(longest_m)),
          glm::vec4(glm::vec3(rows[2]), 0.0F),
          glm::vec4(glm::vec3(bubble.centre_m - middle_m), 0.0F),
          glm::vec4(glm::vec3(bubble.outward), static_cast<float>(bubble.parent))};
}

const scene::Cumulus& CumulusOf(const RenderSettings& settings) {
  return std::get<scene::Cumulus>(settings.technique);
}

bool IsPlain(const RenderSettings& settings) {
  return CumulusOf(settings).component == scene::CumulusComponent::kBalls;
}

// Returns the weights of direct light, inter-reflection, ambient light and corona.
glm::vec4 SharesOf(scene::CumulusComponent component) {
  switch (component) {
    case scene::CumulusComponent::kAll:
    case scene::CumulusComponent::kBalls:
      return glm::vec4(1.0F);
    case scene::CumulusComponent::kDirect:
      return {1.0F, 0.0F, 0.0F, 0.0F};
    case scene::CumulusComponent::kInterReflection:
      return {0.0F, 1.0F, 0.0F, 0.0F};
    case scene::CumulusComponent::kAmbient:
      return {0.0F, 0.0F, 1.0F, 0.0F};
    case scene::CumulusComponent::kCorona:
      return {0.0F, 0.0F, 0.0F, 1.0F};
  }
  return glm::vec4(1.0F);
}

}  // namespace

// Common inputs of the depth pass and the shading pass over the bubbles.
struct CumulusRenderer::Pass {
  scene::View view;
  glm::ivec2 size{1};
  double far_m = 1.0;  // distance that depth 1 stands for
  double corona_m = 1.0;
  double slack_m = 0.0;  // bubbles up to this far behind the nearest core are still drawn
  const gl::Texture2D* ground_distance = nullptr;
  gl::Buffer order;

  Pass(const scene::View& from, const glm::ivec2& target, const CumulusRenderer& renderer);
  BubbleVariant Variant(const CumulusRenderer& renderer, bool front_first) const {
    return {.base = renderer.has_base_,
            .ground = ground_distance != nullptr,
            .front_first = front_first};
  }
};

CumulusRenderer::Pass::Pass(const scene::View& from, const glm::ivec2& target,
                            const CumulusRenderer& renderer)
    : view(from), size(target) {
  const glm::dvec3 eye_m = view.eye_m - renderer.Middle_m();
  // Parallel rays start on a plane, so the distance is measured along the view direction.
  const double reach_m = glm::length(renderer.HalfExtent_m());
  far_m =
      view.Orthographic() ? glm::dot(view.forward, -eye_m) + reach_m : glm::length(eye_m) + reach_m;
  far_m = std::max(far_m, 1.0);
  std::vector<float> nearness(renderer.centres_m_.size());
  const glm::vec3 eye(eye_m);
  const glm::vec3 forward(view.forward);
  for (std::size_t i = 0; i < nearness.size(); ++i) {
    const glm::vec3 away_m = renderer.centres_m_[i] - eye;
    nearness[i] = renderer.radii_m_[i] -
                  (view.Orthographic() ? glm::dot(away_m, forward) : glm::length(away_m));
  }
  std::vector<std::uint32_t> ranks(nearness.size());
  std::iota(ranks.begin(), ranks.end(), 0U);
  std::stable_sort(ranks.begin(), ranks.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return nearness[a] < nearness[b]; });
  order = gl::Buffer(ranks.size() * sizeof(std::uint32_t), ranks.data(), 0);
}

void CumulusRenderer::SetSurface(const clouds::CumulusSurface& surface) {
  count_ = static_cast<int>(surface.bubbles.size());
  centres_m_.clear();
  radii_m_.clear();
  bubbles_ = gl::Buffer();
  if (count_ == 0) return;
  box_ = clouds::BoxOf(surface);
  finest_m_ = surface.finest_m;
  has_base_ = surface.base_m.has_value();
  base_m_ = static_cast<float>(surface.base_m.value_or(0.0) - Middle_m().z);
  std::vector<DeviceBubble> on_device;
  for (const clouds::Bubble& bubble : surface.bubbles) {
    on_device.push_back(OnDevice(bubble, Middle_m()));
    centres_m_.emplace_back(on_device.back().centre_m);
    radii_m_.push_back(on_device.back().unit_x.w);
  }
  bubbles_ = gl::Buffer(on_device.size() * sizeof(DeviceBubble), on_device.data(), 0);
}

double CumulusRenderer::Corona_m(const scene::Cumulus& cumulus) const {
  return finest_m_ * std::max(static_cast<double>(cumulus.corona), kMinCorona);
}

absl::Status CumulusRenderer::DrawBubbles(const gl::Program& program, const Pass& pass,
                                          const gl::PieceCost& bubble) const {
  BindRays(program, pass.view, Middle_m());
  program.Set(uniform::clip_from_local, ClipFromLocal(pass.view, Middle_m()));
  program.Set(uniform::eye, EyeOf(pass.view, Middle_m()));
  program.Set(uniform::last_rank, count_ - 1);
  program.Set(uniform::per_pixel, 2.0F / glm::vec2(pass.size));
  program.Set(uniform::base_m, base_m_);
  program.Set(uniform::corona_m, static_cast<float>(pass.corona_m));
  program.Set(uniform::slack_m, static_cast<float>(pass.slack_m));
  program.Set(uniform::per_far, static_cast<float>(1.0 / pass.far_m));
  bubbles_.BindStorage(shaders::kBubblesBinding);
  pass.order.BindStorage(shaders::kBubbleOrderBinding);
  if (pass.ground_distance != nullptr) pass.ground_distance->Bind(shaders::kGroundDistanceUnit);
  program.Use();
  no_attributes_.Bind();
  return programs_->Pieces().Steps(bubble, count_, [&](int begin, int end) {
    program.Set(uniform::first_bubble, begin);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, end - begin);
  });
}

absl::Status CumulusRenderer::DrawDepth(const Pass& pass, const gl::Framebuffer& target) {
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::Of("cumulus/bubble.vert", "cumulus/depth.frag",
                                           pass.Variant(*this, true).Defines())));
  target.ClearDepth(1.0F);
  target.Bind();
  glEnable(GL_DEPTH_TEST);
  absl::Status drawn = DrawBubbles(*program, pass, kBubbleDepth);
  glDisable(GL_DEPTH_TEST);
  return drawn;
}

absl::Status CumulusRenderer::CastShadow(const RenderSettings& settings) {
  if (shadow_depth_.Get() == 0) {
    shadow_depth_ = gl::Texture2D(GL_DEPTH_COMPONENT32F, glm::ivec2(kShadowTexels));
    shadow_target_ = gl::Framebuffer({}, &shadow_depth_);
  }
  shadow_frame_ = LightFrameOf({HalfExtent_m()}, settings.illumination.towards_sun);
  shadow_reach_m_ = glm::length(HalfExtent_m());
  scene::View from_sun;
  from_sun.eye_m = Middle_m() + (shadow_reach_m_ + kBeforeSurface_m) * shadow_frame_.towards_sun;
  from_sun.forward = -shadow_frame_.towards_sun;
  from_sun.right = shadow_frame_.right;
  from_sun.up = shadow_frame_.up;
  from_sun.tan_half_width = from_sun.tan_half_height = 0.0;
  from_sun.half_width_m = shadow_frame_.half_extent_m.x;
  from_sun.half_height_m = shadow_frame_.half_extent_m.y;
  Pass pass(from_sun, shadow_depth_.Size(), *this);
  pass.corona_m = Corona_m(CumulusOf(settings));
  return DrawDepth(pass, shadow_target_);
}

absl::StatusOr<gl::Texture2D> CumulusRenderer::GroundShadow() {
  gl::Texture2D shadow(GL_RGBA32F, glm::ivec2(kGroundShadowTexels), gl::Edge::kZero);
  const gl::Framebuffer target(shadow);
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::WholeTarget("cumulus/ground_shadow.frag")));
  const double from_m = shadow_reach_m_ + kBeforeSurface_m;
  program->Set(uniform::place_of_depth, glm::vec2(from_m + shadow_reach_m_, -from_m) /
                                            static_cast<float>(shadow_frame_.half_depth_m));
  shadow_depth_.Bind(shaders::kSunDepthUnit);
  THUNDERHEAD_RETURN_IF_ERROR(
      whole_target_.Draw(programs_->Pieces(), kResolvePixel, *program, target));
  return shadow;
}

void CumulusRenderer::Resize(const glm::ivec2& size) {
  if (eye_.Size() == size) return;
  core_depth_ = gl::Texture2D(GL_DEPTH_COMPONENT32F, size);
  core_target_ = gl::Framebuffer({}, &core_depth_);
  cores_ = gl::Texture2D(GL_RGBA16F, size);
  layer_ = gl::Texture2D(GL_RGBA16F, size);
  tested_depth_ = gl::Texture2D(GL_DEPTH_COMPONENT32F, size);
  shade_target_ = gl::Framebuffer({&cores_, &layer_}, &tested_depth_);
  eye_ = gl::Texture2D(GL_RGBA16F, size);
  distances_m_ = gl::Texture2D(GL_R32F, size);
  eye_target_ = gl::Framebuffer({&eye_, &distances_m_});
}

void CumulusRenderer::SetShading(const gl::Program& program, const RenderSettings& settings,
                                 const std::vector<glm::vec3>& light_map, DetailNoises* noises) {
  const scene::Cumulus& cumulus = CumulusOf(settings);
  const scene::View& view = settings.view;
  noise_ = noises->Roughness(kRoughnessOctaves, cumulus.seed);
  const double wave_m = kRoughnessInFinest * finest_m_;
  const double tile_m = wave_m * physics::TurbulenceTile::kWaves;
  const glm::dvec3 corner = Middle_m() / tile_m;
  program.Set(uniform::towards_sun, glm::vec3(settings.illumination.towards_sun));
  BindSunlight(program, settings.illumination, Middle_m().z);
  program.Set(uniform::light_map, light_map);
  program.Set(uniform::component, SharesOf(cumulus.component));
  program.Set(uniform::trap_share, cumulus.trap);
  program.Set(uniform::transmission, cumulus.transmission);
  program.Set(uniform::roughness, cumulus.roughness);
  program.Set(uniform::noise_wave_m, static_cast<float>(wave_m));
  program.Set(uniform::noise_per_m, static_cast<float>(1.0 / tile_m));
  program.Set(uniform::noise_offset, glm::vec3(corner - glm::floor(corner)));
  const double across = view.Orthographic() ? view.half_height_m : view.tan_half_height;
  program.Set(uniform::pixel_share, static_cast<float>(2.0 * across / settings.eye_size.y));
  program.Set(uniform::parallel, view.Orthographic());
  const glm::dvec3 right = 0.5 * shadow_frame_.right / shadow_frame_.half_extent_m.x;
  const glm::dvec3 up = 0.5 * shadow_frame_.up / shadow_frame_.half_extent_m.y;
  const double from_m = shadow_reach_m_ + kBeforeSurface_m;
  const double far_m = from_m + shadow_reach_m_;
  const glm::dvec3 down = -shadow_frame_.towards_sun / far_m;
  program.Set(uniform::shadow_x, glm::vec4(right, 0.5));
  program.Set(uniform::shadow_y, glm::vec4(up, 0.5));
  program.Set(uniform::shadow_z, glm::vec4(down, from_m / far_m));
  program.Set(uniform::shadow_texel_m,
              static_cast<float>(
                  2.0 * std::max(shadow_frame_.half_extent_m.x, shadow_frame_.half_extent_m.y) /
                  kShadowTexels));
  noise_->levels.front().Bind(shaders::kRoughnessNoiseUnit);
  shadow_depth_.Bind(shaders::kSunDepthUnit);
  core_depth_.Bind(shaders::kCoreDepthUnit);
}

absl::Status CumulusRenderer::DrawView(const RenderSettings& settings,
                                       const std::vector<glm::vec3>& light_map,
                                       DetailNoises* noises) {
  Resize(settings.eye_size);
  const bool plain = IsPlain(settings);
  Pass pass(settings.view, settings.eye_size, *this);
  pass.corona_m = plain ? 0.0 : Corona_m(CumulusOf(settings));
  pass.ground_distance = settings.ground_distance;
  THUNDERHEAD_RETURN_IF_ERROR(DrawDepth(pass, core_target_));
  const ShadeVariant variant{.bubble = pass.Variant(*this, false), .plain = plain};
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(
          gl::ProgramSource::Of("cumulus/bubble.vert", "cumulus/shade.frag", variant.Defines())));
  SetShading(*program, settings, light_map, noises);
  shade_target_.Clear(0.0F, 0.0F, 0.0F, 0.0F, 0);
  shade_target_.Clear(0.0F, 0.0F, 0.0F, 1.0F, 1);
  // The shader reads the depths while the depth test uses them, so each needs its own copy.
  glCopyImageSubData(core_depth_.Get(), GL_TEXTURE_2D, 0, 0, 0, 0, tested_depth_.Get(),
                     GL_TEXTURE_2D, 0, 0, 0, 0, settings.eye_size.x, settings.eye_size.y, 1);
  shade_target_.Bind();
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendFunci(0, GL_ONE, GL_ONE);
  glBlendFuncSeparatei(1, GL_ONE, GL_SRC_ALPHA, GL_ZERO, GL_SRC_ALPHA);
  pass.slack_m = pass.corona_m;
  const absl::Status drawn = DrawBubbles(*program, pass, kBubbleShade);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
  glDisable(GL_DEPTH_TEST);
  THUNDERHEAD_RETURN_IF_ERROR(drawn);
  return Resolve(pass.far_m, glm::length(Middle_m() - settings.view.eye_m));
}

absl::Status CumulusRenderer::Resolve(double far_m, double middle_m) {
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::WholeTarget("cumulus/resolve.frag")));
  cores_.Bind(shaders::kCoresUnit);
  layer_.Bind(shaders::kLayerUnit);
  core_depth_.Bind(shaders::kResolvedDepthUnit);
  program->Set(uniform::far_m, static_cast<float>(far_m));
  program->Set(uniform::middle_m, static_cast<float>(middle_m));
  return whole_target_.Draw(programs_->Pieces(), kResolvePixel, *program, eye_target_);
}

std::size_t CumulusRenderer::Bytes() const {
  return bubbles_.Bytes() + shadow_depth_.Bytes() + core_depth_.Bytes() + tested_depth_.Bytes() +
         cores_.Bytes() + layer_.Bytes() + eye_.Bytes() + distances_m_.Bytes() +
         (noise_ != nullptr ? noise_->Bytes() : 0);
}

}  // namespace thunderhead::renderers
