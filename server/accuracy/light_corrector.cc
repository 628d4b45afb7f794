#include "accuracy/light_corrector.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "accuracy/probe_cameras.h"
#include "accuracy/traced_lights.h"
#include "base/status.h"
#include "device_paths/device_tracer.h"
#include "frame/tone_map.h"
#include "glm/common.hpp"
#include "reference/philox.h"
#include "reference/scene_problem.h"
#include "reference/trace_rays.h"
#include "reference/tracking.h"
#include "scene/drawn_fields.h"
#include "scene/ground.h"

namespace thunderhead::accuracy {
namespace {

constexpr int kWidth_px = 128;
constexpr int kHeight_px = 96;
// The maximum number of the correction's texels along one side of the storm's box. With more
// texels, the result was noisier for the same number of paths, and not better after many paths.
constexpr int kMaxTexels = 96;
constexpr double kMaxTexelCount = 262144.0;
// Rays with a higher transmittance than this are not traced, because they carry little information
// about the storm's light.
constexpr double kMaxTransmittance = 0.8;
// The angle below which the forward peak of phase functions is cut off
// (MediumOptions::peak_cut_deg). A cut at 20 degrees gives less noise than one at 3 degrees. The
// difference between the corrected pictures was too small to measure
// (docs/lab/0012-traced-light.md).
constexpr double kPeakCut_deg = 20.0;

// The number of paths for each ray. Drawing a probe takes as long as tracing one path for each of
// its rays, so two paths per ray are efficient. The first kPicturesOfOnePath probes have one path
// per ray, so that the storm is soon seen from many directions (docs/lab/0012-traced-light.md).
constexpr int kPathsOfRay = 2;
constexpr std::uint64_t kPicturesOfOnePath = 8;

constexpr int kGroundTexels = 64;
constexpr int kGroundRays = 2048;       // number of rays from the ground in one pass
constexpr int kGroundPassesOfStep = 2;  // number of passes in each of the first steps
constexpr int kFirstGroundPasses = 32;  // passes before the first probe, because probes show the
                                        // ground
constexpr int kPicturesPerGround = 16;  // number of probes after which the ground's correction is
                                        // updated
constexpr double kAboveGround_m = 1.0;
constexpr std::uint64_t kGroundSeed = 0x67726f756e64;

glm::ivec3 TexelsFor(const volume::WorldBox& box, const glm::dvec3& cell_m) {
  const glm::dvec3 size_m = glm::max(box.high_m - box.low_m, cell_m);
  const double by_side_m = std::max({size_m.x, size_m.y, size_m.z}) / kMaxTexels;
  const double by_count_m = std::cbrt(size_m.x * size_m.y * size_m.z / kMaxTexelCount);
  const glm::dvec3 texel_m = glm::max(glm::dvec3(std::max(by_side_m, by_count_m)), cell_m);
  return glm::clamp(glm::ivec3(glm::ceil(size_m / texel_m)), glm::ivec3(1), glm::ivec3(kMaxTexels));
}

// Returns half the side lengths of the rectangle of ground whose light the storm changes.
glm::dvec2 GroundReach_m(const volume::WorldBox& box) {
  const glm::dvec2 half_m = 0.5 * glm::dvec2(box.high_m - box.low_m);
  return half_m + 0.5 * std::max(half_m.x, half_m.y);
}

glm::dvec2 Middle_m(const volume::WorldBox& box) {
  return 0.5 * glm::dvec2(box.low_m + box.high_m);
}

// Returns the scene that probes draw. It has no lights that the light volume cannot show, no detail
// finer than texels, and uniform ground with the mean brightness of the scene's ground.
scene::Scene ProbedScene(const scene::Scene& asked, const volume::HydrometeorFields& fields) {
  scene::Scene scene = scene::WithGroundOf(asked, fields);
  scene.ground = {};
  scene.lights.clear();
  scene::MediumSettingsOf(&scene.rendering.technique)->look.detail = false;
  scene.rendering.image_scale = 1.0;
  scene.output.width_px = kWidth_px;
  scene.output.height_px = kHeight_px;
  return scene;
}

// Returns the source of the particle sizes with which the storm's box is computed: the papers'
// constants if all fields use them, otherwise the sizes of the weather model.
physics::SizeSource SizesOf(const scene::Scene& scene) {
  const bool papers = std::ranges::all_of(scene.fields, [](const scene::FieldParameters& field) {
    return field.sizes == physics::SizeSource::kPapers;
  });
  return papers ? physics::SizeSource::kPapers : physics::SizeSource::kModel;
}

}  // namespace

bool TracesLight(const scene::Scene& scene, const volume::HydrometeorFields& fields) {
  return scene::TracedLightOf(scene.rendering.technique) != scene::TracedLight::kOff &&
         std::any_of(
             fields.fields.begin(), fields.fields.end(),
             [&](const volume::HydrometeorField& field) { return scene::IsDrawn(scene, field); });
}

LightCorrector::LightCorrector(const scene::Scene& scene,
                               std::shared_ptr<const volume::HydrometeorFields> fields,
                               reference::RayTracer tracer,
                               std::shared_ptr<gl::ProgramCache> programs, int threads)
    : scene_(ProbedScene(scene, *fields)),
      asked_(scene),
      fields_(std::move(fields)),
      tracer_(std::move(tracer)),
      box_(volume::VisibleBox(*fields_, SizesOf(scene_))),
      light_(reference::LightOf(scene_, *fields_)),
      over_ground_(
          reference::SurroundingsOf(scene_, *fields_, reference::GroundLight::kShaded, light_)),
      threads_(threads),
      programs_(std::move(programs)),
      renderer_(programs_),
      storm_fit_(TexelsFor(box_, fields_->grid.spacing_m)),
      ground_fit_({kGroundTexels, kGroundTexels, 1}) {
  over_ground_.air = nullptr;
  over_ground_.shaded_air.reset();
  over_ground_.seen_sky = nullptr;
  over_ground_.disc.reset();
}

absl::StatusOr<std::unique_ptr<LightCorrector>> LightCorrector::Create(
    const scene::Scene& scene, std::shared_ptr<const volume::HydrometeorFields> fields,
    std::shared_ptr<gl::ProgramCache> programs, int threads) {
  THUNDERHEAD_CHECK(TracesLight(scene, *fields), "nothing to be traced");
  reference::MediumOptions options;
  options.peak_cut_deg = kPeakCut_deg;
  options.similar = true;
  THUNDERHEAD_ASSIGN_OR_RETURN(std::shared_ptr<const reference::Medium> medium,
                               reference::MediumOf(ProbedScene(scene, *fields), *fields, options));
  THUNDERHEAD_ASSIGN_OR_RETURN(reference::RayTracer tracer,
                               device_paths::TracersFor(programs)(medium));
  return std::unique_ptr<LightCorrector>(new LightCorrector(
      scene, std::move(fields), std::move(tracer), std::move(programs), threads));
}

bool LightCorrector::Serves(const scene::Scene& scene,
                            const std::shared_ptr<const volume::HydrometeorFields>& fields) const {
  return fields == fields_ && SharesLight(asked_, scene);
}

void LightCorrector::LookAs(const scene::Scene& scene) {
  asked_ = scene;
  scene_ = ProbedScene(scene, *fields_);
}

scene::Camera LightCorrector::NextCamera() const {
  if (pictures_ % 2 == 1) return Nudged(asked_.camera, box_, pictures_);
  return AroundStorm(box_, static_cast<double>(kWidth_px) / kHeight_px, pictures_);
}

absl::Status LightCorrector::Step() {
  ++progress_.steps;
  if (ground_passes_ < kFirstGroundPasses) {
    for (int i = 0; i < kGroundPassesOfStep; ++i) THUNDERHEAD_RETURN_IF_ERROR(TraceGround());
    return absl::OkStatus();
  }
  if (pictures_ % kPicturesPerGround == 0) UpdateGround();
  THUNDERHEAD_RETURN_IF_ERROR(TraceGround());
  scene_.camera = NextCamera();
  ++pictures_;
  THUNDERHEAD_ASSIGN_OR_RETURN(const Probe probe,
                               programs_->Pieces().During([this] { return DrawProbe(); }));
  THUNDERHEAD_RETURN_IF_ERROR(TraceProbe(probe));
  correction_.reset();
  return absl::OkStatus();
}

absl::Status LightCorrector::TraceUntil(std::int64_t paths, const std::stop_token& stop,
                                        const std::function<void(double)>& observer) {
  while (!progress_.HasTraced(paths)) {
    if (stop.stop_requested()) return absl::CancelledError("stopped");
    THUNDERHEAD_RETURN_IF_ERROR(Step());
    if (observer) observer(progress_.ShareOf(paths));
  }
  return absl::OkStatus();
}

absl::StatusOr<LightCorrector::Probe> LightCorrector::DrawProbe() {
  renderers::DrawQuality quality;
  quality.single_precision = true;
  quality.sun_seen = false;  // with such a wide peak cut, there is no aureole around the sun
  quality.correction = plain_;
  Probe probe;
  THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame whole,
                               renderer_.Draw(scene_, fields_, quality));
  // The radiance is null if there is no storm, or if the storm is too faint to be drawn.
  if (whole.storm.radiance == nullptr) return probe;
  probe.whole = frame::ReadLinear(*whole.radiance);
  probe.box = whole.storm.box;
  probe.storm = frame::ReadLinear(*whole.storm.radiance);
  probe.opacity_distance_m = frame::ReadLinear(*whole.storm.opacity_distance_m);
  THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame behind, renderer_.DrawBehind());
  probe.behind = frame::ReadLinear(*behind.radiance);
  return probe;
}

absl::StatusOr<std::vector<glm::dvec3>> LightCorrector::Traced(
    const reference::Surroundings& surroundings, const std::vector<reference::Ray>& rays,
    std::uint64_t seed, int paths_of_ray) const {
  return tracer_(surroundings, rays,
                 {seed, paths_of_ray, threads_, reference::kSimilarAfter,
                  [this] { return programs_->Pieces().Wanted(); }});
}

absl::Status LightCorrector::TraceProbe(const Probe& probe) {
  if (probe.storm.empty()) return absl::OkStatus();
  const reference::Camera camera = reference::CameraOf(scene_, *fields_);
  std::vector<reference::Ray> rays;
  std::vector<std::size_t> firsts;  // indices of the rays' pixels
  for (int y = 0; y < kHeight_px; ++y) {
    for (int x = 0; x < kWidth_px; ++x) {
      const std::size_t first = 4 * static_cast<std::size_t>(y * kWidth_px + x);
      if (probe.storm[first + 3] > kMaxTransmittance) continue;
      firsts.push_back(first);
      rays.push_back(
          camera.RayThrough(2.0 * (x + 0.5) / kWidth_px - 1.0, 2.0 * (y + 0.5) / kHeight_px - 1.0));
    }
  }
  reference::Surroundings surroundings =
      reference::SurroundingsOf(scene_, *fields_, reference::GroundLight::kShaded, light_);
  surroundings.disc.reset();
  const int paths_of_ray = pictures_ > kPicturesOfOnePath ? kPathsOfRay : 1;
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<glm::dvec3> traced,
                               Traced(surroundings, rays, pictures_, paths_of_ray));
  const auto value = [](const std::vector<float>& values, std::size_t first) {
    return glm::dvec3(values[first], values[first + 1], values[first + 2]);
  };
  const volume::WorldBox& box = probe.box;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::size_t first = firsts[i];
    const double opacity = 1.0 - static_cast<double>(probe.storm[first + 3]);
    const glm::dvec3 place_m = rays[i].At(probe.opacity_distance_m[first] / opacity);
    const glm::dvec3 behind = value(probe.behind, first);
    storm_fit_.Add({(place_m - box.low_m) / (box.high_m - box.low_m), rays[i].direction,
                    value(probe.whole, first) - behind, traced[i] - behind});
  }
  progress_.paths += paths_of_ray * static_cast<std::int64_t>(rays.size());
  return absl::OkStatus();
}

// Traces rays from random places on the ground. Their directions are cosine-distributed, so that
// the mean radiance of the rays is the ground's irradiance divided by pi.
absl::Status LightCorrector::TraceGround() {
  const std::uint64_t pass = ground_passes_ + 1;
  if (!over_ground_.ground.has_value() || !over_ground_.sky) {
    ground_passes_ = pass;
    return absl::OkStatus();
  }
  std::vector<reference::Ray> rays;
  std::vector<glm::dvec3> places;
  std::vector<glm::dvec3> skies;
  glm::dvec3 sky_sum = sky_sum_;
  for (int i = 0; i < kGroundRays; ++i) {
    reference::RandomStream random(kGroundSeed, pass, static_cast<std::uint32_t>(i));
    const glm::dvec2 place(random.Uniform(), random.Uniform());
    places.emplace_back(place, 0.5);
    const glm::dvec2 from_m = Middle_m(box_) + (2.0 * place - 1.0) * GroundReach_m(box_);
    rays.push_back({glm::dvec3(from_m, over_ground_.ground->height_m + kAboveGround_m),
                    reference::SampleCosine({0.0, 0.0, 1.0}, &random)});
    skies.push_back(over_ground_.sky(rays.back().direction));
    sky_sum += skies.back();
  }
  const glm::dvec3 mean_sky = sky_sum / static_cast<double>(pass * kGroundRays);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<glm::dvec3> traced,
                               Traced(over_ground_, rays, kGroundSeed + pass, 1));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    // The mean radiance of the clear sky is known, so it replaces the sky that each ray would see
    // (a control variate). Rays that miss the storm therefore add no noise.
    ground_fit_.Add({places[i], glm::dvec3(0.0), mean_sky, mean_sky + traced[i] - skies[i]});
  }
  sky_sum_ = sky_sum;
  ground_passes_ = pass;
  return absl::OkStatus();
}

std::shared_ptr<renderers::LightCorrection> LightCorrector::WithGround() const {
  auto correction = std::make_shared<renderers::LightCorrection>();
  correction->ground_size = glm::ivec2(kGroundTexels);
  for (const Factors& factors : ground_fit_.Solve()) {
    correction->ground.emplace_back(factors[0].x, factors[1].x, factors[2].x, 1.0F);
  }
  correction->ground_low_m = Middle_m(box_) - GroundReach_m(box_);
  correction->ground_high_m = Middle_m(box_) + GroundReach_m(box_);
  return correction;
}

void LightCorrector::UpdateGround() {
  std::shared_ptr<renderers::LightCorrection> correction = WithGround();
  correction->size = glm::ivec3(1);
  for (auto& texels : correction->texels) texels.assign(1, {1.0F, 0.0F, 0.0F, 0.0F});
  plain_ = std::move(correction);
}

std::shared_ptr<const renderers::LightCorrection> LightCorrector::Correction() {
  if (correction_ != nullptr || !progress_.Corrects()) return correction_;
  std::shared_ptr<renderers::LightCorrection> correction = WithGround();
  correction->size = storm_fit_.Size();
  for (const Factors& factors : storm_fit_.Solve()) {
    for (std::size_t color = 0; color < factors.size(); ++color) {
      correction->texels[color].push_back(factors[color]);
    }
  }
  return correction_ = std::move(correction);
}

}  // namespace thunderhead::accuracy
