#include "renderers/light_volume/light_volume_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/mat4x3.hpp"
#include "renderers/light_volume/bindings.h"
#include "renderers/light_volume/cell_blocks.h"
#include "renderers/view_uniforms.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

// Maximum number of texels along each side, at the usual detail.
constexpr int kMaxLightTexels = 256;
// Minimum size of a texel across the sun's rays, at the usual detail.
constexpr double kLightTexelInCells = 0.75;
// Maximum length of a layer along the sun's rays, at the usual detail, relative to the path through
// a cell.
constexpr double kLayerInCells = 1.5;
constexpr std::array kCorrectionUnits = {shaders::kCorrectionRedUnit, shaders::kCorrectionGreenUnit,
                                         shaders::kCorrectionBlueUnit};
// Length, in texels, of the path next to a cell along which the medium is sampled.
constexpr double kNearInTexels = 1.5;
// The carried light is read up to this distance, in texels, beyond the end of that path.
// Interpolation adds one texel along each axis.
constexpr double kReadBeyond = 1.74;
constexpr double kMarchedSample_ns = 15.0;  // guessed cost of a sample of the medium
constexpr gl::PieceCost kArriveBlock{"arrive", 12000.0};

// Returns true if multiple scattering is computed in closed form.
bool IsDiffuse(const RenderSettings& settings) {
  return settings.Medium().transport == scene::Transport::kConsistent;
}

// Returns true if multiple scattering comes from the diffusion equation.
bool Diffuses(const RenderSettings& settings) {
  return settings.Medium().transport == scene::Transport::kDiffusion;
}

// Returns the limits of the march's step near the eye. The first limit is in cells, the second is
// relative to the distance from the eye. Inside or close to a cloud, steps that are long relative
// to their distance are visible as flat layers, which move as the eye moves. Frames with few
// samples also have longer steps there.
glm::vec2 NearStep(int slices) {
  constexpr double kInCells = 0.25;
  constexpr double kByDistance = 1.0 / 24.0;
  const double usual_slices = scene::LightVolume{}.slices;
  return glm::vec2(std::max(usual_slices / slices, 1.0) * glm::dvec2(kInCells, kByDistance));
}

}  // namespace

// The box in which light is carried. Its axes are across and along the sun's rays, and its centre
// is the medium's middle.
struct LightVolumeRenderer::LightBox {
  LightFrame frame;
  double reach_m = 0.0;  // half the depth of the box
  // Length of the path from a cell towards the sun along which the medium is sampled.
  double near_m = 0.0;
  double read_m = 0.0;  // the carried light is read up to this distance from scattering cells
  glm::ivec3 size{1};
  int half_layer_steps = 1;  // number of samples of the medium in half a layer

  LightBox(const ResidentMedium& medium, const RenderSettings& settings);
  // Returns the transformation from local metres to texture coordinates.
  glm::mat4x3 FromLocal() const;
};

LightVolumeRenderer::LightBox::LightBox(const ResidentMedium& medium,
                                        const RenderSettings& settings) {
  const glm::dvec3& towards_sun = settings.illumination.towards_sun;
  const glm::dvec3 half_m = medium.HalfExtent_m();
  const glm::dvec3 cell_m = medium.Bounds().grid.spacing_m;
  frame = LightFrameOf({half_m}, towards_sun);
  reach_m = frame.half_depth_m;
  const glm::dvec2 across_m = 2.0 * frame.half_extent_m;
  const int max_texels =
      std::max(static_cast<int>(kMaxLightTexels * settings.quality.light_detail), 1);
  // Texels much finer than cells would add no detail, so kLightTexelInCells limits them.
  const double texel_m =
      std::max(std::max(across_m.x, across_m.y) / max_texels,
               kLightTexelInCells / settings.quality.light_detail * std::min(cell_m.x, cell_m.y));
  const glm::dvec3 through_m = cell_m / glm::max(glm::abs(towards_sun), glm::dvec3(1e-6));
  const double layer_m = std::min(texel_m, kLayerInCells / settings.quality.light_detail *
                                               std::min({through_m.x, through_m.y, through_m.z}));
  const auto layers_of = [&](double one_m) {
    return std::clamp(static_cast<int>(std::ceil(2.0 * reach_m / one_m)), 1, max_texels);
  };
  int usual_layers = layers_of(layer_m);
  size = glm::ivec3(
      glm::clamp(glm::ivec2(glm::ceil(across_m / texel_m)), glm::ivec2(1), glm::ivec2(max_texels)),
      layers_of(settings.quality.light_layer * layer_m));
  if (settings.Medium().transport == scene::Transport::kPaper) {
    // The paper's transport depends on the number of its steps, so the steps are the scene's
    // slices.
    const int slices = *scene::SlicesOf(settings.technique);
    size.z = usual_layers = std::clamp((slices + 1) / 2, 1, max_texels);
    half_layer_steps = std::max(1, (slices + size.z) / (2 * size.z));
  }
  // The path sampled next to a cell keeps its length even if layers are longer than usual.
  near_m = kNearInTexels * std::max(texel_m, 2.0 * reach_m / usual_layers);
  read_m = near_m + kReadBeyond * std::max(texel_m, 2.0 * reach_m / size.z);
}

glm::mat4x3 LightVolumeRenderer::LightBox::FromLocal() const {
  const glm::dvec3 right = 0.5 * frame.right / frame.half_extent_m.x;
  const glm::dvec3 up = 0.5 * frame.up / frame.half_extent_m.y;
  const glm::dvec3 down = -0.5 * frame.towards_sun / reach_m;
  return {right.x, up.x, down.x, right.y, up.y, down.y, right.z, up.z, down.z, 0.5, 0.5, 0.5};
}

void LightVolumeRenderer::Resize(const glm::ivec3& carried, const glm::ivec3& cells,
                                 GLenum format) {
  if (carried_.Size() != carried || light_format_ != format) {
    carried_ = gl::Texture3D(format, carried);
    carried_.Clear();
    thickness_ = gl::Texture2D(GL_R32F, glm::ivec2(carried));
    shadow_ = gl::Texture2D(GL_RGBA32F, glm::ivec2(carried), gl::Edge::kZero);
  }
  if (arrived_.Size() != cells || light_format_ != format) {
    arrived_ = gl::Texture3D(format, cells);
    // The march may read texels that were never written and multiply them by the weight 0, so they
    // must be finite.
    arrived_.Clear();
    // The texture is allocated now, so that a lack of memory is reported now and not later, while
    // the camera or the sun moves.
    if (!gl::ComputesWholeTargets() && near_ratio_.Size() != cells) {
      near_ratio_ = {};
      near_ratio_ = gl::Texture3D(GL_R8, cells);
      near_version_ = 0;
    }
  }
  light_format_ = format;
}

absl::Status LightVolumeRenderer::CarryLight(const ResidentMedium& medium,
                                             const RenderSettings& settings,
                                             const GroundFinder& find_ground) {
  const LightBox box(medium, settings);
  const GroupWeights weights(medium.Content(), settings.Medium());
  const bool diffuse = IsDiffuse(settings);
  const GLenum one = settings.quality.single_precision ? GL_R32F : GL_R16F;
  const GLenum two = settings.quality.single_precision ? GL_RG32F : GL_RG16F;
  Resize(box.size, medium.Bounds().grid.cells, diffuse ? two : one);
  const CarryVariant variant{.consistent = !scene::IsPaper(settings.Medium().transport),
                             .translucent = scene::IsTranslucent(settings.Medium().transport),
                             .diffuse = diffuse};
  THUNDERHEAD_RETURN_IF_ERROR(light_medium_.Update(medium, weights, diffuse));
  THUNDERHEAD_RETURN_IF_ERROR(Carry(medium, weights, box, variant));
  THUNDERHEAD_RETURN_IF_ERROR(
      Arrive(medium, weights, box, variant, settings.quality.light_in_turns));
  if (!Diffuses(settings)) return absl::OkStatus();
  LitGround ground;
  if (find_ground != nullptr) {
    THUNDERHEAD_ASSIGN_OR_RETURN(ground, find_ground());
  }
  return diffusion_.Solve(medium, weights, arrived_, settings.illumination.towards_sun,
                          settings.quality.light_tolerance, ground,
                          settings.quality.light_in_turns);
}

absl::Status LightVolumeRenderer::Carry(const ResidentMedium& medium, const GroupWeights& weights,
                                        const LightBox& box, const CarryVariant& variant) {
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::Compute("light_volume/carry.comp", variant.Defines())));
  medium.BindBox(*program);
  medium.BindBricks(*program);
  light_medium_.Bind(*program);
  program->Set(uniform::light_size, box.size);
  program->Set(uniform::towards_sun, glm::vec3(box.frame.towards_sun));
  program->Set(uniform::light_right_m, glm::vec3(box.frame.right * box.frame.half_extent_m.x));
  program->Set(uniform::light_up_m, glm::vec3(box.frame.up * box.frame.half_extent_m.y));
  program->Set(uniform::light_reach_m, static_cast<float>(box.reach_m));
  program->Set(uniform::read_m, static_cast<float>(box.read_m));
  program->Set(uniform::half_layer_steps, box.half_layer_steps);
  program->Set(uniform::read_bricks,
               static_cast<int>(std::ceil(box.read_m / medium.ShortestBrickSide_m())));
  program->Set(uniform::cumulative_phase, weights.cumulative_phase);
  carried_.BindImage(shaders::kCarriedImage, GL_WRITE_ONLY);
  thickness_.BindImage(shaders::kThicknessImage, GL_WRITE_ONLY);
  shadow_.BindImage(shaders::kShadowImage, GL_WRITE_ONLY);
  program->Use();
  const glm::ivec3 groups = (box.size + shaders::kLightGroupSide - 1) / shaders::kLightGroupSide;
  const double rays = static_cast<double>(box.size.x) * shaders::kLightGroupSide;
  const double steps = 2.0 * box.size.z * box.half_layer_steps;
  absl::Status carried = programs_->Pieces().Steps(
      {"carry", rays * steps * kMarchedSample_ns}, groups.y, [&](int begin, int end) {
        program->Set(uniform::first_row, begin * shaders::kLightGroupSide);
        glDispatchCompute(static_cast<GLuint>(groups.x), static_cast<GLuint>(end - begin), 1);
      });
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  return carried;
}

absl::Status LightVolumeRenderer::Arrive(const ResidentMedium& medium, const GroupWeights& weights,
                                         const LightBox& box, const CarryVariant& variant,
                                         bool in_turns) {
  const int blocks = medium.BlockCount();
  if (!in_turns || near_ratio_.Size() != arrived_.Size()) {
    return ArriveIn(medium, weights, box, variant, 0, 0, blocks);
  }
  if (near_version_ != light_medium_.Version()) {
    near_parts_.Forget();
    near_version_ = light_medium_.Version();
  }
  const SunParts::Parts parts = near_parts_.Next(box.frame.towards_sun, in_turns);
  constexpr auto kParts = static_cast<int>(SunParts::kCount);
  for (int part = 0; part < kParts; ++part) {
    const int near = parts[static_cast<std::size_t>(part)] ? 1 : 2;
    THUNDERHEAD_RETURN_IF_ERROR(ArriveIn(medium, weights, box, variant, near,
                                         blocks * part / kParts, blocks * (part + 1) / kParts));
  }
  near_parts_.Found(parts, box.frame.towards_sun);
  return absl::OkStatus();
}

absl::Status LightVolumeRenderer::ArriveIn(const ResidentMedium& medium,
                                           const GroupWeights& weights, const LightBox& box,
                                           const CarryVariant& variant, int near, int first,
                                           int end) {
  const ArriveVariant arrive{.medium = medium.Variant(), .carry = variant, .near = near};
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::Compute("light_volume/arrive.comp", arrive.Defines())));
  medium.Bind(*program);
  program->Set(uniform::light_weights, medium.Weights(weights.light));
  program->Set(uniform::light_from_local, box.FromLocal());
  program->Set(uniform::towards_sun, glm::vec3(box.frame.towards_sun));
  program->Set(uniform::near_m, static_cast<float>(box.near_m));
  carried_.Bind(shaders::kCarriedUnit);
  thickness_.Bind(shaders::kThicknessUnit);
  arrived_.BindImage(shaders::kArrivedImage, GL_WRITE_ONLY);
  if (near > 0) light_medium_.Bind(*program);
  if (near == 1) near_ratio_.BindImage(shaders::kNearRatioImage, GL_WRITE_ONLY);
  if (near == 2) near_ratio_.Bind(shaders::kNearRatioUnit);
  absl::Status arrived =
      ForCellBlocks(programs_->Pieces(), kArriveBlock, medium, *program, first, end);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  return arrived;
}

void LightVolumeRenderer::BindDiffusion(const gl::Program& program, const ResidentMedium& medium,
                                        const GroupWeights& weights,
                                        const RenderSettings& settings) {
  program.Set(uniform::transport_weights, medium.Weights(weights.transport));
  program.Set(uniform::rest_of_sky, settings.illumination.rest_of_sky);
  program.Set(uniform::rest_of_sky_level, settings.illumination.rest_of_sky_level);
  program.Set(uniform::around_sun, settings.illumination.around_sun);
  program.Set(uniform::from_ground, settings.illumination.from_ground);
  constexpr std::array kTints = {uniform::red_weights, uniform::green_weights,
                                 uniform::blue_weights};
  for (int color = 0; color < 3; ++color) {
    std::vector<double> tint = weights.diffusing;
    for (std::size_t i = 0; i < tint.size(); ++i) tint[i] *= weights.color[i][color];
    program.Set(kTints[static_cast<std::size_t>(color)], medium.Weights(tint));
  }
  diffusion_.Bind();
}

void LightVolumeRenderer::BindCorrection(const std::shared_ptr<const LightCorrection>& correction) {
  for (std::size_t color = 0; color < correction_textures_.size(); ++color) {
    gl::Texture3D& texture = correction_textures_[color];
    if (correction_ != correction) {
      if (texture.Size() != correction->size) {
        texture = gl::Texture3D(GL_RGBA16F, correction->size);
      }
      texture.Upload(GL_RGBA, GL_FLOAT, correction->texels[color].data());
    }
    texture.Bind(kCorrectionUnits[color]);
  }
  correction_ = correction;
}

absl::Status LightVolumeRenderer::DrawView(const ResidentMedium& medium,
                                           const RenderSettings& settings) {
  drawn_ = settings.chosen != nullptr ? 1 : 0;
  CoveredTarget& eye = eyes_[drawn_];
  eye.Resize(settings.quality.single_precision ? GL_RGBA32F : GL_RGBA16F, settings.eye_size,
             settings.cover, true);
  const GroupWeights weights(medium.Content(), settings.Medium());
  const bool diffusion = Diffuses(settings);
  const MarchVariant variant{.medium = medium.Variant(),
                             .colored = weights.colored,
                             .consistent = !scene::IsPaper(settings.Medium().transport),
                             .ground = settings.ground_distance != nullptr,
                             .even_albedo = weights.even_albedo,
                             .diffusion = diffusion,
                             .tinted = diffusion && (weights.colored || weights.absorbs),
                             .corrected = settings.quality.correction != nullptr,
                             .chosen = settings.chosen != nullptr};
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::WholeTarget("light_volume/march.frag", variant.Defines())));
  medium.BindWithBricks(*program);
  weights.BindScattered(*program, medium, settings.illumination);
  const scene::View& view = settings.view;
  const double reach_m = glm::dot(glm::abs(view.forward), medium.HalfExtent_m());
  BindRays(*program, view, medium.Middle_m());
  medium.BindPixel(*program, view, settings.detail_size.value_or(settings.eye_size));
  program->Set(uniform::towards_sun, glm::vec3(settings.illumination.towards_sun));
  program->Set(uniform::step_m, static_cast<float>(2.0 * reach_m / settings.slices));
  program->Set(uniform::near_step, NearStep(settings.slices));
  program->Set(uniform::eye_weights, medium.Weights(weights.eye));
  if (diffusion) BindDiffusion(*program, medium, weights, settings);
  arrived_.Bind(shaders::kArrivedUnit);
  if (settings.quality.correction != nullptr) BindCorrection(settings.quality.correction);
  if (settings.ground_distance != nullptr)
    settings.ground_distance->Bind(shaders::kGroundDistanceUnit);
  if (settings.cover != nullptr) {
    eye.Target().Clear(0.0F, 0.0F, 0.0F, 1.0F);
    eye.Target().Clear(0.0F, 0.0F, 0.0F, 0.0F, 1);
  }
  const LimitedTo limited(Where::kCovered, settings.cover);
  const gl::PieceCost ray{"march", kMarchedSample_ns * settings.slices};
  if (settings.chosen == nullptr) {
    return whole_target_.Draw(programs_->Pieces(), ray, *program, eye.Target());
  }
  settings.chosen->Bind();
  return whole_target_.Draw(programs_->Pieces(), ray, *program, eye.Target(),
                            settings.chosen->Rect());
}

std::size_t LightVolumeRenderer::Bytes() const {
  std::size_t bytes = carried_.Bytes() + thickness_.Bytes() + shadow_.Bytes() + arrived_.Bytes() +
                      near_ratio_.Bytes() + light_medium_.Bytes() + diffusion_.Bytes();
  for (const CoveredTarget& eye : eyes_) bytes += eye.Texture().Bytes() + eye.Distances().Bytes();
  return bytes;
}

}  // namespace thunderhead::renderers
