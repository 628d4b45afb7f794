// Measures the error of a drawn picture by tracing some of its pixels: what the picture shows
// against the reference (reference/trace_scene.h), on the scene and storm that it shows. Traces on
// the processors and needs no GL.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>

#include "absl/status/statusor.h"
#include "accuracy/error_estimate.h"
#include "picture/linear_picture.h"
#include "reference/camera.h"
#include "reference/medium.h"
#include "reference/surroundings.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::accuracy {

class ErrorMeter {
 public:
  // Of pictures of `scene` with any number of pixels, of the aspect that its output has. Fails as
  // reference::MediumOf. Traces on `threads` threads, 0: all cores.
  static absl::StatusOr<std::unique_ptr<ErrorMeter>> Create(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      int threads);

  // Traces pixels of `drawn` (rows from top to bottom) for about `seconds`, or until `stop` asks to
  // stop. Further calls must be given the same picture, and make the estimate finer.
  void Measure(const picture::LinearPicture& drawn, double seconds, const std::stop_token& stop);

  // None while too few pixels are traced.
  std::optional<MeasuredError> Result() const { return estimate_.Result(); }

 private:
  ErrorMeter(std::shared_ptr<const reference::Medium> medium, reference::Surroundings surroundings,
             const reference::Camera& camera, int threads);

  void TraceBatch(const picture::LinearPicture& drawn);

  const std::shared_ptr<const reference::Medium> medium_;
  const reference::Surroundings surroundings_;
  const reference::Camera camera_;
  const int threads_;
  ErrorEstimate estimate_;
  int paths_per_pixel_;
  std::uint64_t batches_ = 0;
};

}  // namespace thunderhead::accuracy
