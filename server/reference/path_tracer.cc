#include "reference/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "base/status.h"
#include "reference/parallel.h"
#include "reference/path_radiance.h"

namespace thunderhead::reference {
namespace {

constexpr int kTile_px = 16;
// Number of samples below which the error estimate is too uncertain to stop on it.
constexpr int kFewestForError = 16;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Returns the limit that has been reached, if any.
std::optional<RefineEnd> EndAt(const RefineLimits& limits, const ImageProgress& progress) {
  const int samples = progress.samples_per_pixel;
  if (limits.samples_per_pixel > 0 && samples >= limits.samples_per_pixel) {
    return RefineEnd::kSamples;
  }
  if (limits.relative_error > 0.0 && samples >= kFewestForError &&
      progress.relative_error <= limits.relative_error) {
    return RefineEnd::kRelativeError;
  }
  if (limits.seconds > 0.0 && samples > 0 && progress.seconds >= limits.seconds) {
    return RefineEnd::kSeconds;
  }
  return std::nullopt;
}

double Sum(const glm::dvec3& color) { return color.x + color.y + color.z; }

}  // namespace

void PathTracer::Pixel::Add(const PathEstimate& path) {
  ++samples;
  met_medium += path.met_medium ? 1 : 0;
  const glm::dvec3 before = path.radiance - mean;
  mean += before / static_cast<double>(samples);
  squares += before * (path.radiance - mean);
}

glm::dvec3 PathTracer::Pixel::SquaredError() const {
  if (samples < 2) return glm::dvec3(kInfinity);
  return squares / (static_cast<double>(samples) * (samples - 1));
}

PathTracer::PathTracer(std::shared_ptr<const Medium> medium, Surroundings surroundings,
                       const Camera& camera, const glm::ivec2& size_px,
                       const PathTracerOptions& options)
    : medium_(std::move(medium)),
      surroundings_(std::move(surroundings)),
      camera_(camera),
      size_px_(size_px),
      options_(options) {
  THUNDERHEAD_CHECK(size_px.x > 0 && size_px.y > 0, std::to_string(size_px.x));
  pixels_.resize(static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y));
}

void PathTracer::RefinePixel(int x, int y, int until_samples) {
  const auto index = static_cast<std::size_t>(y) * static_cast<std::size_t>(size_px_.x) +
                     static_cast<std::size_t>(x);
  Pixel& pixel = pixels_[index];
  while (pixel.samples < until_samples) {
    RandomStream random(options_.seed, index, static_cast<std::uint32_t>(pixel.samples));
    const double right = 2.0 * (x + random.Uniform()) / size_px_.x - 1.0;
    const double up = 1.0 - 2.0 * (y + random.Uniform()) / size_px_.y;
    pixel.Add(EstimateRadiance(*medium_, surroundings_, camera_.RayThrough(right, up), &random,
                               {.max_scatterings = options_.max_scatterings}));
  }
}

void PathTracer::RunTile(const Pass& pass, const glm::ivec2& low_px) {
  for (int y = low_px.y; y < std::min(low_px.y + kTile_px, size_px_.y); ++y) {
    for (int x = low_px.x; x < std::min(low_px.x + kTile_px, size_px_.x); ++x) {
      if (pass.must_end()) return;
      RefinePixel(x, y, pass.until_samples);
    }
  }
}

void PathTracer::RunPass(const Pass& pass) {
  const glm::ivec2 tiles = (size_px_ + kTile_px - 1) / kTile_px;
  ParallelFor(options_.threads, tiles.x * tiles.y, [&](int tile) {
    RunTile(pass, glm::ivec2(tile % tiles.x, tile / tiles.x) * kTile_px);
  });
}

int PathTracer::FewestSamples() const {
  const auto fewer = [](const Pixel& a, const Pixel& b) { return a.samples < b.samples; };
  return std::min_element(pixels_.begin(), pixels_.end(), fewer)->samples;
}

std::int64_t PathTracer::AllSamples() const {
  std::int64_t sum = 0;
  for (const Pixel& pixel : pixels_) sum += pixel.samples;
  return sum;
}

double PathTracer::RelativeError() const {
  double squares = 0.0;
  double radiance = 0.0;
  for (const Pixel& pixel : pixels_) {
    squares += Sum(pixel.SquaredError());
    radiance += Sum(pixel.mean);
  }
  if (squares == 0.0) return 0.0;
  if (!(radiance > 0.0)) return kInfinity;
  const double values = 3.0 * static_cast<double>(pixels_.size());
  return std::sqrt(squares / values) / (radiance / values);
}

// Returns the sample count at which the next pass ends. Passes grow with the number of samples, so
// that checking the result after each pass takes little time. They stay short enough for a viewer
// to see progress.
int PathTracer::PassTarget(const RefineLimits& limits) const {
  constexpr int kMaxInPass = 16;
  const int have = FewestSamples();
  int target = have + std::clamp(have / 4, 1, kMaxInPass);
  if (limits.samples_per_pixel > 0) target = std::min(target, limits.samples_per_pixel);
  return target;
}

ImageProgress PathTracer::ProgressOf(double seconds, std::int64_t samples_before) const {
  ImageProgress progress;
  progress.samples_per_pixel = FewestSamples();
  progress.seconds = seconds;
  progress.relative_error = RelativeError();
  progress.samples_per_second =
      static_cast<double>(AllSamples() - samples_before) / std::max(seconds, 1e-9);
  return progress;
}

RefineResult PathTracer::Refine(const RefineLimits& limits, const ImageObserver& observer,
                                const std::stop_token& stop) {
  const auto start = limits.time->Now();
  const auto seconds = [&] { return 1e-3 * base::MsSince(*limits.time, start); };
  const auto timed_out = [&] { return limits.seconds > 0.0 && seconds() >= limits.seconds; };
  const auto pauses = [&] { return limits.pause_s > 0.0 && seconds() >= limits.pause_s; };
  const std::int64_t samples_before = AllSamples();
  for (;;) {
    const ImageProgress progress = ProgressOf(seconds(), samples_before);
    if (observer) observer(progress);
    if (const auto end = EndAt(limits, progress)) return {*end, progress};
    if (stop.stop_requested()) return {RefineEnd::kStopped, progress};
    if (pauses()) return {RefineEnd::kPaused, progress};
    const bool first = progress.samples_per_pixel == 0;
    RunPass({PassTarget(limits),
             [&, first] { return stop.stop_requested() || pauses() || (!first && timed_out()); }});
  }
}

picture::LinearPicture PathTracer::Snapshot() const {
  picture::LinearPicture image;
  image.size_px = size_px_;
  image.radiance.reserve(pixels_.size());
  image.standard_error.reserve(pixels_.size());
  image.opacity.reserve(pixels_.size());
  for (const Pixel& pixel : pixels_) {
    image.radiance.emplace_back(pixel.mean);
    image.standard_error.emplace_back(glm::sqrt(pixel.SquaredError()));
    image.opacity.push_back(static_cast<float>(pixel.met_medium) /
                            static_cast<float>(std::max(pixel.samples, 1)));
  }
  return image;
}

}  // namespace thunderhead::reference
