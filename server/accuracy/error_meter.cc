#include "accuracy/error_meter.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/status.h"
#include "base/stopwatch.h"
#include "glm/common.hpp"
#include "reference/near_sun.h"
#include "reference/philox.h"
#include "reference/scene_problem.h"
#include "reference/trace_scene.h"

namespace thunderhead::accuracy {
namespace {

// The first kPilotPixels pixels get kFirstPathsPerPixel paths each. After them, the number of paths
// is chosen by ErrorEstimate::BestPathsPerPixel.
constexpr int kFirstPathsPerPixel = 16;
constexpr std::int64_t kPilotPixels = 320;
constexpr int kMaxPathsPerPixel = 64;
// Number of paths that take some tenths of a second on two cores.
constexpr int kPathsPerBatch = 4096;
constexpr std::uint64_t kSeed = 0x6572726f72;

// The fraction kEvenShare of the pixels is chosen evenly over the picture, so that no error is
// missed. For the other pixels, kWithoutStorm is the relative weight of pixels that show no storm.
constexpr double kEvenShare = 0.2;
constexpr double kWithoutStorm = 0.05;
// The minimum radiance that is assumed for a pixel, relative to the mean radiance. A pixel that is
// drawn darker may be brighter in the reference.
constexpr double kDark = 0.25;

double MeanColor(const glm::vec3& color) {
  return (static_cast<double>(color.x) + color.y + color.z) / 3.0;
}

}  // namespace

ErrorMeter::ErrorMeter(reference::RayTracer tracer, reference::Surroundings surroundings,
                       const reference::Camera& camera, int threads, std::uint64_t seed)
    : tracer_(std::move(tracer)),
      surroundings_(std::move(surroundings)),
      camera_(camera),
      threads_(threads),
      seed_(seed + kSeed),
      paths_per_pixel_(kFirstPathsPerPixel) {}

absl::StatusOr<std::unique_ptr<ErrorMeter>> ErrorMeter::Create(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
    int threads, std::uint64_t seed, const reference::MakesTracer& makes_tracer) {
  // Errors are measured against the reference technique, in which each field has its own phase
  // function, whatever technique has drawn the picture.
  scene::Scene reference_scene = scene;
  reference_scene.rendering.technique =
      scene::Reference{.false_colors = scene::FieldLookOf(scene.rendering.technique).false_colors};
  reference::MediumOptions options;
  options.peak_cut_deg = reference::kPeakCut_deg;
  options.similar = true;
  THUNDERHEAD_ASSIGN_OR_RETURN(std::shared_ptr<const reference::Medium> medium,
                               reference::MediumOf(reference_scene, *fields, options));
  THUNDERHEAD_ASSIGN_OR_RETURN(reference::RayTracer tracer, makes_tracer(medium));
  return std::unique_ptr<ErrorMeter>(new ErrorMeter(
      std::move(tracer),
      reference::SurroundingsOf(reference_scene, *fields, reference::GroundLight::kShaded),
      reference::CameraOf(reference_scene, *fields), threads, seed));
}

void ErrorMeter::Show(picture::LinearPicture drawn) {
  const bool keeps = drawn.size_px == drawn_.size_px;
  drawn_ = std::move(drawn);
  if (!keeps) {
    Weigh();
    traced_.clear();
  }
  if (!IsMeasurable()) return estimate_.reset();
  double sum = 0.0;
  for (std::size_t i = 0; i < drawn_.radiance.size(); ++i) {
    if (ChanceOf(i) > 0.0) sum += MeanColor(drawn_.radiance[i]);
  }
  mean_drawn_ = sum / static_cast<double>(pixels_);
  estimate_.emplace(mean_drawn_);
  for (const TracedPixel& pixel : traced_) {
    estimate_->Add(glm::dvec3(drawn_.radiance[pixel.index]), pixel.reference);
  }
}

// Computes the probabilities of choosing pixels. They increase with radiance, because most of the
// noise and the error is in the bright parts of the storm.
void ErrorMeter::Weigh() {
  const std::vector<bool> left_out = reference::NearSun(camera_, surroundings_.towards_sun,
                                                        drawn_.size_px, reference::kPeakCut_deg);
  std::vector<double> worth(drawn_.radiance.size(), 0.0);
  double sum = 0.0;
  pixels_ = 0;
  for (std::size_t i = 0; i < worth.size(); ++i) {
    if (left_out[i]) continue;
    const double opacity = drawn_.opacity.empty() ? 1.0 : static_cast<double>(drawn_.opacity[i]);
    worth[i] = std::max(MeanColor(drawn_.radiance[i]), 0.0) *
               (kWithoutStorm + (1.0 - kWithoutStorm) * std::clamp(opacity, 0.0, 1.0));
    sum += worth[i];
    ++pixels_;
  }
  const double even_share = sum > 0.0 ? kEvenShare : 1.0;
  chances_.resize(worth.size());
  double before = 0.0;
  for (std::size_t i = 0; i < worth.size(); ++i) {
    if (!left_out[i]) {
      before += even_share / static_cast<double>(pixels_);
      if (sum > 0.0) before += (1.0 - even_share) * worth[i] / sum;
    }
    chances_[i] = before;
  }
}

bool ErrorMeter::IsMeasurable() const {
  return static_cast<double>(pixels_) >=
         reference::kLeastAwayFromSun * static_cast<double>(drawn_.radiance.size());
}

double ErrorMeter::ChanceOf(std::size_t index) const {
  return chances_[index] - (index > 0 ? chances_[index - 1] : 0.0);
}

// Returns the index of pixel number `count` in an endless sequence. The sequence is evenly
// distributed in cumulative probability (multiples of the golden ratio).
std::size_t ErrorMeter::ChoosePixel(std::uint64_t count) const {
  constexpr double kGolden = 0.6180339887498949;
  const double place = glm::fract(0.5 + static_cast<double>(count) * kGolden) * chances_.back();
  const auto found = std::ranges::upper_bound(chances_, place);
  return std::min(static_cast<std::size_t>(found - chances_.begin()), chances_.size() - 1);
}

void ErrorMeter::Measure(double seconds, const std::stop_token& stop) {
  if (!IsMeasurable()) return;
  const auto wanted = [&stop] {
    return stop.stop_requested() ? absl::CancelledError("stopped") : absl::OkStatus();
  };
  const base::Stopwatch stopwatch;
  while (Step(wanted).ok() && stopwatch.ElapsedMs() < 1e3 * seconds) {
  }
}

absl::Status ErrorMeter::Step(const reference::IsWanted& wanted) {
  THUNDERHEAD_CHECK(estimate_.has_value(), "no picture that can be measured was shown");
  const base::Stopwatch stopwatch;
  if (estimate_->Pixels() >= kPilotPixels) {
    paths_per_pixel_ = estimate_->BestPathsPerPixel(kMaxPathsPerPixel);
  }
  const auto per_pixel = static_cast<std::size_t>(paths_per_pixel_);
  const std::size_t pixels = std::max<std::size_t>(kPathsPerBatch / per_pixel, 1);
  const std::uint64_t batch = ++batches_;
  const glm::dvec2 size_px(drawn_.size_px);
  std::vector<reference::Ray> rays;
  std::vector<std::size_t> indices;
  rays.reserve(pixels * per_pixel);
  for (std::size_t i = 0; i < pixels; ++i) {
    indices.push_back(ChoosePixel(traced_.size() + i));
    const auto width = static_cast<std::size_t>(drawn_.size_px.x);
    const glm::dvec2 corner_px(indices.back() % width, indices.back() / width);
    for (std::size_t path = 0; path < per_pixel; ++path) {
      reference::RandomStream random(seed_, batch, static_cast<std::uint32_t>(rays.size()));
      const double x = corner_px.x + random.Uniform();
      const double y = corner_px.y + random.Uniform();
      rays.push_back(camera_.RayThrough(2.0 * x / size_px.x - 1.0, 1.0 - 2.0 * y / size_px.y));
    }
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const std::vector<glm::dvec3> radiance,
      tracer_(surroundings_, rays, {seed_ + batch, 1, threads_, reference::kSimilarAfter, wanted}));
  for (std::size_t i = 0; i < pixels; ++i) {
    const double weight = 1.0 / (ChanceOf(indices[i]) * static_cast<double>(pixels_));
    const double usual = std::max(MeanColor(drawn_.radiance[indices[i]]), kDark * mean_drawn_);
    TracedPixel pixel{indices[i], PixelReference(usual, weight)};
    for (const glm::dvec3& one : std::span(radiance).subspan(i * per_pixel, per_pixel)) {
      pixel.reference.Add(one);
    }
    estimate_->Add(glm::dvec3(drawn_.radiance[pixel.index]), pixel.reference);
    traced_.push_back(pixel);
  }
  traced_s_ += 1e-3 * stopwatch.ElapsedMs();
  return absl::OkStatus();
}

std::optional<MeasuredError> ErrorMeter::Result() const {
  return estimate_.has_value() ? estimate_->Result() : std::nullopt;
}

}  // namespace thunderhead::accuracy
