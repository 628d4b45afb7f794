// Traces a picture of a medium progressively: each pixel's mean radiance and standard error. The
// result after a number of samples is bit-identical for any number of threads and any division of
// the samples among calls. This code does not use GL, files or messages.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "base/time_source.h"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "picture/linear_picture.h"
#include "reference/camera.h"
#include "reference/medium.h"
#include "reference/path_radiance.h"
#include "reference/surroundings.h"

namespace thunderhead::reference {

struct PathTracerOptions {
  std::uint64_t seed = 0;
  int threads = 0;  // number of threads; 0 means as many as the machine has
  // Largest number of scatterings by the medium. Light scattered more often is omitted. 0 means no
  // limit.
  int max_scatterings = 0;
};

// Limits of a call of Refine, which ends at the first limit reached. A limit of 0 does not apply.
// If no limit applies, the call continues until it is stopped.
struct RefineLimits {
  int samples_per_pixel = 0;  // samples for each pixel, in total over all calls
  // Duration of this call. At least one sample for each pixel is always finished.
  double seconds = 0.0;
  // ImageProgress::relative_error; it needs at least 16 samples for each pixel.
  double relative_error = 0.0;
  // Duration after which this call pauses, even if some pixels have no sample.
  double pause_s = 0.0;
  // The clock of `seconds` and `pause_s`. It must outlive the call.
  const base::TimeSource* time = &base::SteadyTime();
};

struct ImageProgress {
  int samples_per_pixel = 0;  // the smallest number over all pixels
  double seconds = 0.0;       // duration of the call of Refine so far
  // The root mean square of the standard error over pixels and colours, divided by the picture's
  // mean radiance. It is infinite below two samples for each pixel.
  double relative_error = 0.0;
  double samples_per_second = 0.0;  // paths per second, in that call
};

// A callback that Refine calls between passes, on its caller's thread.
using ImageObserver = std::function<void(const ImageProgress&)>;

enum class RefineEnd { kSamples, kSeconds, kRelativeError, kStopped, kPaused };

struct RefineResult {
  RefineEnd end = RefineEnd::kStopped;
  ImageProgress progress;
};

class PathTracer {
 public:
  PathTracer(std::shared_ptr<const Medium> medium, Surroundings surroundings, const Camera& camera,
             const glm::ivec2& size_px, const PathTracerOptions& options);

  // Adds samples until a limit is reached or `stop` requests a stop. A stop can leave some pixels
  // with more samples than others. The pixels' means are still unbiased, and the next call
  // continues from there. `observer` may be empty. Calls must not overlap.
  RefineResult Refine(const RefineLimits& limits, const ImageObserver& observer,
                      const std::stop_token& stop);

  // Returns the picture with its standard error, which is infinite for a pixel with fewer than two
  // samples. The opacity is the share of samples that met the medium first.
  picture::LinearPicture Snapshot() const;

 private:
  // The mean of a pixel's samples, and the sum of squared differences from it (Welford 1962).
  struct Pixel {
    glm::dvec3 mean{0.0};
    glm::dvec3 squares{0.0};
    int samples = 0;
    int met_medium = 0;

    void Add(const PathEstimate& path);
    glm::dvec3 SquaredError() const;
  };
  struct Pass {
    int until_samples = 0;
    std::function<bool()> must_end;
  };

  void RunPass(const Pass& pass);
  void RunTile(const Pass& pass, const glm::ivec2& low_px);
  void RefinePixel(int x, int y, int until_samples);
  int PassTarget(const RefineLimits& limits) const;
  int FewestSamples() const;
  std::int64_t AllSamples() const;
  ImageProgress ProgressOf(double seconds, std::int64_t samples_before) const;
  double RelativeError() const;

  std::shared_ptr<const Medium> medium_;
  Surroundings surroundings_;
  Camera camera_;
  glm::ivec2 size_px_;
  PathTracerOptions options_;
  std::vector<Pixel> pixels_;
};

}  // namespace thunderhead::reference
