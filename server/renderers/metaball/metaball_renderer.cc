#include "renderers/metaball/metaball_renderer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_format.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "renderers/light_frame.h"
#include "renderers/metaball/bindings.h"
#include "renderers/metaball/light_order.h"
#include "renderers/metaball/tiles.h"
#include "renderers/metaball/variants.h"
#include "renderers/sunlight.h"
#include "renderers/view_uniforms.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

// Minimum and maximum number of texels along the longer side of the light buffer.
constexpr int kMinBallLightTexels = 64;
constexpr int kMaxBallLightTexels = 1024;
// Number of texels across the ball whose radius is the 10th percentile of all radii.
constexpr double kTexelsAcrossBall = 8.0;

// Wavelength of the surfaces' longest wave, in radii of the mean ball.
constexpr double kWaveInRadii = 1.5;

constexpr gl::PieceCost kSplatPixel{"splat", 1000.0};
constexpr gl::PieceCost kBallLevel{"balls' light", 2e5};
constexpr gl::PieceCost kDiffuseBall{"balls' diffuse light", 5000.0};

// A ball in the layout of shaders/metaball/balls.glsl.
struct DeviceBall {
  glm::vec4 middle_radius;
  glm::vec4 optics;
  glm::vec4 scattering[2];
  glm::vec4 tint;
};

bool IsPaper(const RenderSettings& settings) { return scene::IsPaper(settings.Medium().transport); }

const scene::Metaballs& MetaballsOf(const RenderSettings& settings) {
  return std::get<scene::Metaballs>(settings.technique);
}

absl::Status Check(const std::vector<Ball>& balls) {
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Ball& ball = balls[i];
    const double sum = glm::dot(ball.middle_m, glm::dvec3(1.0)) + ball.radius_m;
    if (std::isfinite(sum) && ball.radius_m > 0.0 && std::isfinite(ball.extinction_per_m) &&
        ball.extinction_per_m >= 0.0) {
      continue;
    }
    return absl::InvalidArgumentError(absl::StrFormat(
        "ball %d at %g, %g, %g m has a radius of %g m and an extinction of %g 1/m; a radius must "
        "be above 0, an extinction 0 or above, and every number finite",
        i, ball.middle_m.x, ball.middle_m.y, ball.middle_m.z, ball.radius_m,
        ball.extinction_per_m));
  }
  return absl::OkStatus();
}

// Returns the factor t of eq. 18 (Man, "Generating and Real-Time Rendering of Clouds"): densities
// rho = t v. The paper does not specify t. With the factor used here, the mean ball has the density
// 1, which is also the upper limit.
double PaperDensityFactor(const std::vector<Ball>& balls) {
  double sum = 0.0;
  for (const Ball& ball : balls) sum += ball.extinction_per_m;
  return sum > 0.0 ? static_cast<double>(balls.size()) / sum : 0.0;
}

DeviceBall DeviceBallOf(const Ball& ball, const Medium& content, const GroupWeights& weights,
                        const glm::dvec3& middle_m) {
  DeviceBall device{};
  device.middle_radius = {glm::vec3(ball.middle_m - middle_m), ball.radius_m};
  glm::dvec3 optics(0.0);
  glm::vec3 tint(0.0F);
  for (std::size_t i = 0; i < content.groups.size(); ++i) {
    const double share = ball.shares[i];
    optics += share * glm::dvec3(weights.eye[i], weights.light[i], weights.transport[i]);
    tint += static_cast<float>(share * weights.scattering[i]) * content.groups[i].color;
  }
  for (std::size_t i = 0; i < content.groups.size(); ++i) {
    device.scattering[i / 4][static_cast<int>(i % 4)] =
        static_cast<float>(ball.shares[i] * weights.scattering[i] / std::max(optics.x, 1e-12));
  }
  device.optics = glm::vec4(glm::vec3(optics * ball.extinction_per_m), 0.0F);
  device.tint = glm::vec4(tint, 0.0F);
  return device;
}

std::vector<glm::vec4> NumbersOf(const std::vector<DeviceBall>& balls) {
  std::vector<glm::vec4> numbers;
  for (const DeviceBall& ball : balls) {
    numbers.insert(numbers.end(), {ball.middle_radius, ball.optics, ball.scattering[0],
                                   ball.scattering[1], ball.tint});
  }
  return numbers;
}

// The light buffer's axes and size.
struct LightPlane {
  LightFrame frame;
  glm::ivec2 size{1};
  double texels_per_m = 1.0;

  glm::dvec2 TexelOf(const glm::dvec3& local_m) const {
    return texels_per_m * glm::dvec2(glm::dot(local_m, frame.right), glm::dot(local_m, frame.up)) +
           0.5 * glm::dvec2(size);
  }
};

LightPlane LightPlaneOf(const std::vector<Ball>& balls, const BallBox& box,
                        const glm::dvec3& towards) {
  std::vector<double> radii_m;
  radii_m.reserve(balls.size());
  for (const Ball& ball : balls) radii_m.push_back(ball.radius_m);
  const auto small = radii_m.begin() + static_cast<std::ptrdiff_t>(radii_m.size() / 10);
  std::nth_element(radii_m.begin(), small, radii_m.end());
  LightPlane plane;
  plane.frame = LightFrameOf({box.HalfExtent_m()}, towards);
  const glm::dvec2 across_m = 2.0 * plane.frame.half_extent_m;
  const double longest_m = std::max(across_m.x, across_m.y);
  plane.texels_per_m = std::clamp(0.5 * kTexelsAcrossBall / *small, kMinBallLightTexels / longest_m,
                                  kMaxBallLightTexels / longest_m);
  plane.size = glm::max(glm::ivec2(glm::ceil(across_m * plane.texels_per_m)), glm::ivec2(1));
  return plane;
}

gl::Buffer BufferOf(const std::vector<std::uint32_t>& values) {
  // GL does not allow an empty buffer. This single element is never read.
  if (values.empty()) return {sizeof(std::uint32_t), nullptr, 0};
  return {values.size() * sizeof(std::uint32_t), values.data(), 0};
}

}  // namespace

std::vector<MetaballRenderer::Light> MetaballRenderer::LightsOf(const RenderSettings& settings) {
  const Illumination& from = settings.illumination;
  std::vector<Light> lights = {{from.towards_sun, glm::vec3(1.0F), false}};
  if (IsPaper(settings)) {
    // The paper has only directional lights. Each half of the sky is therefore represented by a
    // light from its middle.
    const float half_sky = std::numbers::pi_v<float>;
    lights.push_back({{0.0, 0.0, 1.0}, half_sky * from.from_sky, false});
    lights.push_back({{0.0, 0.0, -1.0}, half_sky * from.from_ground, false});
  }
  for (const Beam& beam : from.beams) lights.push_back({beam.towards, beam.irradiance, false});
  // The diffuse light must be last, because source.comp expects it there.
  if (!IsPaper(settings)) {
    lights.push_back({{0.0, 0.0, 1.0}, glm::vec3(0.0F), true});
  }
  return lights;
}

void MetaballRenderer::Upload(const BallCloud& cloud, const Medium& content,
                              const RenderSettings& settings) {
  balls_ = cloud.balls;
  box_ = BoxOf(balls_);
  const GroupWeights weights(content, settings.Medium());
  content_ = content;
  groups_ = static_cast<int>(content.groups.size());
  colored_ = weights.colored;
  std::vector<physics::PhaseFunction> phases;
  for (const MediumGroup& group : content.groups) phases.push_back(group.phase);
  phase_curves_ = PhaseCurves(phases);
  const double paper_factor = PaperDensityFactor(balls_);
  std::vector<DeviceBall> device;
  for (const Ball& ball : balls_) {
    device.push_back(DeviceBallOf(ball, content, weights, box_.Middle_m()));
    if (!IsPaper(settings)) continue;
    const double density = std::min(paper_factor * ball.extinction_per_m, 1.0);
    device.back().optics.x = static_cast<float>(MetaballsOf(settings).optical_depth * density);
  }
  const bool paper = IsPaper(settings);
  Optics optics{NumbersOf(device), paper, paper ? MetaballsOf(settings).albedo : 0.0,
                scene::IsTranslucent(settings.Medium().transport)};
  if (optics == optics_) return;
  optics_ = std::move(optics);
  lights_.clear();
  if (balls_.empty()) return;
  ball_buffer_ = gl::Buffer(device.size() * sizeof(DeviceBall), device.data(), 0);
  sources_ = gl::Buffer(balls_.size() * sizeof(glm::vec4), nullptr, 0);
}

std::vector<int> MetaballRenderer::KeepArrived(const std::vector<Light>& lights) {
  const std::size_t bytes = balls_.size() * sizeof(glm::vec2);
  gl::Buffer arrived(lights.size() * bytes, nullptr, 0);
  // The buffer copies below need the results of earlier shaders.
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::vector<int> missing;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const auto known = std::find_if(lights_.begin(), lights_.end(),
                                    [&](const Light& light) { return light.ArrivesAs(lights[i]); });
    if (known == lights_.end()) {
      missing.push_back(static_cast<int>(i));
      continue;
    }
    const auto from = static_cast<std::size_t>(known - lights_.begin());
    glCopyNamedBufferSubData(arrived_.Get(), arrived.Get(), static_cast<GLintptr>(from * bytes),
                             static_cast<GLintptr>(i * bytes), static_cast<GLsizeiptr>(bytes));
  }
  arrived_ = std::move(arrived);
  lights_.clear();
  return missing;
}

absl::Status MetaballRenderer::CarryLight(const BallCloud& cloud, const Medium& content,
                                          const RenderSettings& settings) {
  THUNDERHEAD_RETURN_IF_ERROR(Check(cloud.balls));
  Upload(cloud, content, settings);
  carried_lights_ = 0;
  if (balls_.empty()) return absl::OkStatus();
  std::vector<Light> lights = LightsOf(settings);
  for (const int i : KeepArrived(lights)) {
    THUNDERHEAD_RETURN_IF_ERROR(Carry(lights[static_cast<std::size_t>(i)], i, settings));
    ++carried_lights_;
  }
  lights_ = std::move(lights);
  return absl::OkStatus();
}

absl::Status MetaballRenderer::Carry(const Light& light, int index,
                                     const RenderSettings& settings) {
  const bool paper = IsPaper(settings);
  const auto program_of = [&](int pass) {
    const BallLightVariant variant{.paper = paper, .pass = pass, .diffuse = light.diffuse};
    return programs_->Get(gl::ProgramSource::Compute("metaball/light.comp", variant.Defines()));
  };
  const LightPlane plane = LightPlaneOf(balls_, box_, light.towards);
  std::vector<LightDisc> discs;
  for (const Ball& ball : balls_) {
    const glm::dvec3 local_m = ball.middle_m - box_.Middle_m();
    discs.push_back({plane.TexelOf(local_m), std::max(ball.radius_m * plane.texels_per_m, 1.0),
                     glm::dot(local_m, light.towards)});
  }
  const LightOrder order = OrderFromLight(discs, plane.size);
  order_ = BufferOf(order.discs);
  if (light_.Size() != plane.size) light_ = gl::Texture2D(GL_RG32F, plane.size);
  // Optical depths begin at 0. The paper's light begins at 1 (white).
  const float clear[2] = {paper ? 1.0F : 0.0F, 0.0F};
  glClearTexImage(light_.Get(), 0, GL_RG, GL_FLOAT, clear);
  light_.BindImage(shaders::kBallLightImage, GL_READ_WRITE);
  ball_buffer_.BindStorage(shaders::kBallsBinding);
  arrived_.BindStorage(shaders::kBallArrivedBinding);
  order_.BindStorage(shaders::kBallOrderBinding);
  const auto run = [&](const gl::Program& program, std::uint32_t first, std::uint32_t end) {
    program.Set(uniform::first, static_cast<int>(first));
    glDispatchCompute(end - first, 1, 1);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
  };
  for (int pass = 0; pass < (paper ? 1 : 2); ++pass) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const gl::Program* program, program_of(pass));
    program->Set(uniform::arrived_first, index * static_cast<int>(balls_.size()));
    program->Set(uniform::light_right, glm::vec3(plane.frame.right * plane.texels_per_m));
    program->Set(uniform::light_up, glm::vec3(plane.frame.up * plane.texels_per_m));
    program->Set(uniform::texels_per_m, static_cast<float>(plane.texels_per_m));
    program->Set(uniform::light_middle, 0.5F * glm::vec2(plane.size));
    program->Set(uniform::paper_albedo, static_cast<float>(MetaballsOf(settings).albedo));
    program->Set(uniform::scattered_often,
                 scene::IsTranslucent(settings.Medium().transport) ? 1.0F : 0.0F);
    program->Use();
    gl::Pieces& pieces = programs_->Pieces();
    if (pass == 1) {
      THUNDERHEAD_RETURN_IF_ERROR(
          pieces.Steps(kDiffuseBall, static_cast<int>(balls_.size()), [&](int begin, int end) {
            run(*program, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
          }));
      continue;
    }
    THUNDERHEAD_RETURN_IF_ERROR(
        pieces.Steps(kBallLevel, static_cast<int>(order.Levels()), [&](int begin, int end) {
          for (auto level = static_cast<std::size_t>(begin); level < static_cast<std::size_t>(end);
               ++level) {
            run(*program, order.starts[level], order.starts[level + 1]);
          }
        }));
  }
  return absl::OkStatus();
}

absl::Status MetaballRenderer::DrawView(const RenderSettings& settings, const scene::Detail& detail,
                                        DetailNoises* noises) {
  if (eye_.Size() != settings.eye_size) {
    eye_ = gl::Texture2D(GL_RGBA32F, settings.eye_size);
    distances_m_ = gl::Texture2D(GL_R32F, settings.eye_size);
    eye_target_ = gl::Framebuffer({&eye_, &distances_m_});
  }
  if (balls_.empty()) {
    eye_target_.Clear(0.0F, 0.0F, 0.0F, 1.0F);
    eye_target_.Clear(0.0F, 0.0F, 0.0F, 0.0F, 1);
    return absl::OkStatus();
  }
  THUNDERHEAD_RETURN_IF_ERROR(FindSources(settings));
  return Splat(settings, detail, noises);
}

absl::Status MetaballRenderer::FindSources(const RenderSettings& settings) {
  const bool paper = IsPaper(settings);
  std::vector<glm::vec3> towards;
  std::vector<glm::vec3> irradiance;
  // The lights' colours are read again, because a change of haze changes them. The share of a light
  // that arrives at each ball is not affected.
  for (const Light& light : LightsOf(settings)) {
    if (light.diffuse) continue;
    towards.emplace_back(light.towards);
    irradiance.push_back(light.irradiance);
  }
  const BallSourceVariant variant{.lights = static_cast<int>(towards.size()),
                                  .groups = groups_,
                                  .colored = colored_,
                                  .paper = paper,
                                  .isotropic = MetaballsOf(settings).isotropic,
                                  .parallel = settings.view.Orthographic()};
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::Compute("metaball/source.comp", variant.Defines())));
  const GroupWeights weights(content_, settings.Medium());
  weights.BindPhase(*program);
  program->Set(uniform::ball_count, static_cast<int>(balls_.size()));
  program->Set(uniform::eye_forward, glm::vec3(settings.view.forward));
  program->Set(uniform::eye_m, glm::vec3(settings.view.eye_m - box_.Middle_m()));
  program->Set(uniform::towards_light, towards);
  program->Set(uniform::irradiance, irradiance);
  BindSunlight(*program, settings.illumination, box_.Middle_m().z);
  program->Set(uniform::sky_radiance, settings.illumination.from_sky);
  program->Set(uniform::ground_radiance, settings.illumination.from_ground);
  program->Set(uniform::paper_albedo, static_cast<float>(MetaballsOf(settings).albedo));
  phase_curves_.Bind();
  ball_buffer_.BindStorage(shaders::kBallsBinding);
  arrived_.BindStorage(shaders::kBallArrivedBinding);
  sources_.BindStorage(shaders::kBallSourcesBinding);
  program->Use();
  const auto groups = (balls_.size() + shaders::kBallGroupSize - 1) / shaders::kBallGroupSize;
  glDispatchCompute(static_cast<GLuint>(groups), 1, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return absl::OkStatus();
}

// Sets the noise of the balls' surfaces. Its longest wave is shorter than the diameter of the mean
// ball. The function binds the coarsest level whose texels are no larger than a pixel at the near
// side of the balls' box. If no level has such texels, it binds the finest level.
void MetaballRenderer::BindNoise(const gl::Program& program, const RenderSettings& settings,
                                 float share) const {
  double mean_radius_m = 0.0;
  double largest_radius_m = 0.0;
  for (const Ball& ball : balls_) {
    mean_radius_m += ball.radius_m / static_cast<double>(balls_.size());
    largest_radius_m = std::max(largest_radius_m, ball.radius_m);
  }
  const double tile_m = kWaveInRadii * mean_radius_m * physics::DetailTile::kWaves;
  const glm::dvec3 corner = box_.Middle_m() / tile_m;
  program.Set(uniform::noise_per_m, static_cast<float>(1.0 / tile_m));
  program.Set(uniform::noise_offset, glm::vec3(corner - glm::floor(corner)));
  program.Set(uniform::roughness, share);
  // The factor is a margin for the rounding of distances.
  program.Set(uniform::largest_radius_m, static_cast<float>(1.001 * largest_radius_m));
  const scene::View& view = settings.view;
  const double away_m =
      glm::length(glm::max(glm::abs(view.eye_m - box_.Middle_m()) - box_.HalfExtent_m(), 0.0));
  const double across_m = view.Orthographic() ? view.half_height_m : view.tan_half_height * away_m;
  const double pixel_m = 2.0 * across_m / settings.eye_size.y;
  const double texels = pixel_m * physics::DetailTile::kSide / tile_m;
  const auto level = static_cast<std::size_t>(std::floor(std::log2(std::max(texels, 1.0))));
  noise_->levels[std::min(level, noise_->levels.size() - 1)].Bind(shaders::kDetailNoiseUnit);
}

absl::Status MetaballRenderer::Splat(const RenderSettings& settings, const scene::Detail& detail,
                                     DetailNoises* noises) {
  // A ball holds all fields at once, so the noise of one field represents all fields.
  const bool rough = noises != nullptr && detail.share > 0.0F && !IsPaper(settings);
  if (rough) noise_ = noises->Get(detail.octaves, detail.seed);
  const SplatVariant variant{
      .paper = IsPaper(settings), .ground = settings.ground_distance != nullptr, .detail = rough};
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::WholeTarget("metaball/splat.frag", variant.Defines())));
  const BallTiles tiles = TilesOf(balls_, settings.view, settings.eye_size);
  tile_starts_ = BufferOf(tiles.starts);
  order_ = BufferOf(tiles.balls);
  BindRays(*program, settings.view, box_.Middle_m());
  if (rough) BindNoise(*program, settings, detail.share);
  program->Set(uniform::tile_px, tiles.tile_px);
  program->Set(uniform::tiles_across, tiles.tiles.x);
  ball_buffer_.BindStorage(shaders::kBallsBinding);
  tile_starts_.BindStorage(shaders::kBallTilesBinding);
  order_.BindStorage(shaders::kBallOrderBinding);
  sources_.BindStorage(shaders::kBallSourcesBinding);
  if (settings.ground_distance != nullptr)
    settings.ground_distance->Bind(shaders::kGroundDistanceUnit);
  return whole_target_.Draw(programs_->Pieces(), kSplatPixel, *program, eye_target_);
}

std::size_t MetaballRenderer::Bytes() const {
  return ball_buffer_.Bytes() + arrived_.Bytes() + sources_.Bytes() + order_.Bytes() +
         tile_starts_.Bytes() + light_.Bytes() + eye_.Bytes() + distances_m_.Bytes() +
         phase_curves_.Bytes();
}

}  // namespace thunderhead::renderers
