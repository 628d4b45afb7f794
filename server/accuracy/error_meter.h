// Measures the error of a drawn picture by path tracing some of its pixels. The traced radiance is
// that of the reference technique (reference/trace_scene.h) for the same scene and storm. This
// class does not use GL itself, but its tracer may.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "accuracy/error_estimate.h"
#include "picture/linear_picture.h"
#include "reference/camera.h"
#include "reference/surroundings.h"
#include "reference/trace_rays.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::accuracy {

class ErrorMeter {
 public:
  // Creates a meter for pictures of `scene` with any number of pixels and the aspect ratio of its
  // output. Returns the errors of reference::MediumOf and `makes_tracer`. If paths are traced on
  // the CPU, `threads` threads are used; 0 means one for each core. `seed` selects the random
  // paths.
  static absl::StatusOr<std::unique_ptr<ErrorMeter>> Create(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      int threads, std::uint64_t seed = 0,
      const reference::MakesTracer& makes_tracer = reference::TracerOnProcessors);

  // Sets the picture to measure. Paths that were traced before are kept if the picture has the same
  // size as the previous picture.
  void Show(picture::LinearPicture drawn);

  // Returns false if almost all pixels of the last shown picture are close to the sun. Pixels close
  // to the sun are not measured (reference/near_sun.h).
  bool IsMeasurable() const;

  // Traces pixels of the picture for some tenths of a second. A measurable picture must have been
  // shown. Returns the errors of `wanted` and of the tracer. If it fails, it adds no pixel.
  absl::Status Step(const reference::IsWanted& wanted = nullptr);
  // Calls Step for about `seconds`, or until `stop` is requested. Does nothing if the picture is
  // not measurable.
  void Measure(double seconds, const std::stop_token& stop);

  // Returns the measured error of the last shown picture, or nothing while too few pixels are
  // traced.
  std::optional<MeasuredError> Result() const;
  // Returns the seconds spent in Step so far.
  double TracedSeconds() const { return traced_s_; }

 private:
  struct TracedPixel {
    std::size_t index;
    PixelReference reference;
  };

  ErrorMeter(reference::RayTracer tracer, reference::Surroundings surroundings,
             const reference::Camera& camera, int threads, std::uint64_t seed);

  void Weigh();
  std::size_t ChoosePixel(std::uint64_t count) const;
  double ChanceOf(std::size_t index) const;

  const reference::RayTracer tracer_;
  const reference::Surroundings surroundings_;
  const reference::Camera camera_;
  const int threads_;
  const std::uint64_t seed_;
  picture::LinearPicture drawn_;
  double mean_drawn_ = 0.0;
  std::size_t pixels_ = 0;  // number of pixels of drawn_ that are measured
  // The cumulative probabilities of choosing each pixel, computed from the first shown picture of
  // this size.
  std::vector<double> chances_;
  std::vector<TracedPixel> traced_;
  std::optional<ErrorEstimate> estimate_;
  int paths_per_pixel_;
  std::uint64_t batches_ = 0;
  double traced_s_ = 0.0;
};

}  // namespace thunderhead::accuracy
