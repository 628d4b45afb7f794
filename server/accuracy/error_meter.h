// Measures the error of a drawn picture by tracing some of its pixels: what the picture shows
// against the reference (reference/trace_scene.h), on the scene and storm that it shows. Knows no
// GL, though paths may be traced by it.
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
  // Of pictures of `scene` with any number of pixels, of the aspect that its output has. Fails as
  // reference::MediumOf and `makes_tracer`. Traces on `threads` threads, 0: all cores, where it is
  // the processors that trace; other random paths by `seed`.
  static absl::StatusOr<std::unique_ptr<ErrorMeter>> Create(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      int threads, std::uint64_t seed = 0,
      const reference::MakesTracer& makes_tracer = reference::TracerOnProcessors);

  // The picture whose error is measured from now on. Paths traced before count for it too, if it
  // has as many pixels as the one before; else they are given up.
  void Show(picture::LinearPicture drawn);

  // False if the picture shown last looks at hardly anything but the sun, next to which nothing is
  // measured (reference/near_sun.h).
  bool IsMeasurable() const;

  // Traces pixels of the picture for some tenths of a second; one that is measurable must have been
  // shown. Fails only as `wanted` does, and has traced nothing then.
  absl::Status Step(const reference::IsWanted& wanted = nullptr);
  // Steps for about `seconds`, or until `stop` asks to stop; not at all if nothing is measurable.
  void Measure(double seconds, const std::stop_token& stop);

  // Of the picture shown last. None while too few pixels are traced.
  std::optional<MeasuredError> Result() const;
  // So far, by steps.
  double TracedSeconds() const { return traced_s_; }

 private:
  struct TracedPixel {
    std::size_t index;
    PixelTruth truth;
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
  std::size_t pixels_ = 0;  // of it, without those that are left out
  // Cumulative probability with which each pixel is chosen; by the picture shown first.
  std::vector<double> chances_;
  std::vector<TracedPixel> traced_;
  std::optional<ErrorEstimate> estimate_;
  int paths_per_pixel_;
  std::uint64_t batches_ = 0;
  double traced_s_ = 0.0;
};

}  // namespace thunderhead::accuracy
