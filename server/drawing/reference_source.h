// The interface through which the render loop refines a picture with the Monte Carlo reference. The
// reference implements it; service tests use a fake. A ReferenceSource is used by one thread at a
// time. This code does not depend on sessions.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>

#include "absl/status/status.h"
#include "drawing/frame_source.h"
#include "glm/vec2.hpp"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::drawing {

class ReferenceSource {
 public:
  virtual ~ReferenceSource() = default;

  // Begins a picture of `size_px`, which overrides the scene's size. The picture has no samples
  // yet.
  virtual absl::Status Begin(const scene::Scene& scene,
                             const std::shared_ptr<const volume::HydrometeorFields>& fields,
                             const glm::ivec2& size_px) = 0;

  // Adds samples until each pixel has `until_samples`, but for at most `seconds` and until `stop`
  // is requested. A further call continues.
  virtual delivery::Refinement Refine(int until_samples, double seconds,
                                      const std::stop_token& stop) = 0;

  virtual picture::LinearPicture Snapshot() = 0;
};

using ReferenceSourceFactory = std::function<std::unique_ptr<ReferenceSource>()>;

// Returns the reference on `threads` threads. 0 means all cores except those left for other work,
// which are a quarter of the cores and at least one.
std::unique_ptr<ReferenceSource> MakeReferenceSource(int threads = 0);

}  // namespace thunderhead::drawing
