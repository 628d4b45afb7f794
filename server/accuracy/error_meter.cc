#include "accuracy/error_meter.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "base/status.h"
#include "base/stopwatch.h"
#include "reference/philox.h"
#include "reference/scene_problem.h"
#include "reference/trace_rays.h"
#include "reference/trace_scene.h"

namespace thunderhead::accuracy {
namespace {

// Before anything is known of the picture, and the pixels that are enough to know it.
constexpr int kFirstPathsPerPixel = 16;
constexpr std::int64_t kPilotPixels = 320;
constexpr int kMaxPathsPerPixel = 128;
// Some tenths of a second on two cores.
constexpr int kPathsPerBatch = 4096;
constexpr std::uint64_t kSeed = 0x6572726f72;

// Pixel `index` of an endless sequence that covers the picture evenly (Roberts 2018, R2: multiples
// of powers of the plastic number).
glm::ivec2 PixelAt(std::uint64_t index, const glm::ivec2& size_px) {
  constexpr glm::dvec2 kPlaceStep(0.7548776662466927, 0.5698402909980532);
  const glm::dvec2 place = glm::fract(0.5 + static_cast<double>(index) * kPlaceStep);
  return glm::min(glm::ivec2(place * glm::dvec2(size_px)), size_px - 1);
}

}  // namespace

ErrorMeter::ErrorMeter(std::shared_ptr<const reference::Medium> medium,
                       reference::Surroundings surroundings, const reference::Camera& camera,
                       int threads)
    : medium_(std::move(medium)),
      surroundings_(std::move(surroundings)),
      camera_(camera),
      threads_(threads),
      paths_per_pixel_(kFirstPathsPerPixel) {}

absl::StatusOr<std::unique_ptr<ErrorMeter>> ErrorMeter::Create(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
    int threads) {
  // As the reference shows it: each field with its own phase function.
  scene::Scene truth = scene;
  truth.rendering.technique = scene::Reference{};
  reference::MediumOptions options;
  options.peak_cut_deg = reference::kPeakCut_deg;
  THUNDERHEAD_ASSIGN_OR_RETURN(std::shared_ptr<const reference::Medium> medium,
                               reference::MediumOf(truth, *fields, options));
  return std::unique_ptr<ErrorMeter>(new ErrorMeter(
      std::move(medium), reference::SurroundingsOf(truth, *fields, reference::GroundLight::kShaded),
      reference::CameraOf(truth, *fields), threads));
}

void ErrorMeter::Measure(const picture::LinearPicture& drawn, double seconds,
                         const std::stop_token& stop) {
  const base::Stopwatch stopwatch;
  do {
    TraceBatch(drawn);
    if (estimate_.Pixels() >= kPilotPixels) {
      paths_per_pixel_ = estimate_.BestPathsPerPixel(kMaxPathsPerPixel);
    }
  } while (!stop.stop_requested() && stopwatch.ElapsedMs() < 1e3 * seconds);
}

void ErrorMeter::TraceBatch(const picture::LinearPicture& drawn) {
  const auto per_pixel = static_cast<std::size_t>(paths_per_pixel_);
  const std::size_t pixels = std::max<std::size_t>(kPathsPerBatch / per_pixel, 1);
  const std::uint64_t batch = ++batches_;
  std::vector<reference::Ray> rays;
  std::vector<glm::dvec3> shown;
  rays.reserve(pixels * per_pixel);
  for (std::size_t i = 0; i < pixels; ++i) {
    const glm::ivec2 pixel =
        PixelAt(static_cast<std::uint64_t>(estimate_.Pixels()) + i, drawn.size_px);
    shown.emplace_back(drawn.radiance[static_cast<std::size_t>(pixel.y) *
                                          static_cast<std::size_t>(drawn.size_px.x) +
                                      static_cast<std::size_t>(pixel.x)]);
    for (std::size_t path = 0; path < per_pixel; ++path) {
      reference::RandomStream random(kSeed, batch, static_cast<std::uint32_t>(rays.size()));
      const double x = 2.0 * (pixel.x + random.Uniform()) / drawn.size_px.x - 1.0;
      const double y = 1.0 - 2.0 * (pixel.y + random.Uniform()) / drawn.size_px.y;
      rays.push_back(camera_.RayThrough(x, y));
    }
  }
  const std::vector<glm::dvec3> traced =
      reference::TraceRays(*medium_, surroundings_, rays, {kSeed + batch, 1, threads_});
  for (std::size_t i = 0; i < pixels; ++i) {
    estimate_.Add(shown[i], std::span(traced).subspan(i * per_pixel, per_pixel));
  }
}

}  // namespace thunderhead::accuracy
