// Path-traces pictures of a changing scene at different sizes. The class keeps the parts that a
// change of the scene does not affect, above all the medium. This code does not use sessions.
#pragma once

#include <memory>
#include <optional>
#include <stop_token>

#include "absl/status/status.h"
#include "glm/vec2.hpp"
#include "reference/path_tracer.h"
#include "reference/surroundings.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::reference {

class SceneTracer {
 public:
  // `peak_cut_deg` is MediumOptions::peak_cut_deg.
  SceneTracer(double peak_cut_deg, const PathTracerOptions& options);

  // Begins a picture of `size_px` without any samples. The size may differ from the scene's size.
  absl::Status Begin(const scene::Scene& scene,
                     const std::shared_ptr<const volume::HydrometeorFields>& fields,
                     const glm::ivec2& size_px);

  // Refines like PathTracer::Refine. Begin must have been called.
  RefineResult Refine(const RefineLimits& limits, const std::stop_token& stop);
  picture::LinearPicture Snapshot() const;

 private:
  absl::Status Prepare(const scene::Scene& scene,
                       const std::shared_ptr<const volume::HydrometeorFields>& fields);

  const double peak_cut_deg_;
  const PathTracerOptions options_;
  // The inputs from which the kept parts were made.
  std::optional<scene::Scene> prepared_scene_;
  std::weak_ptr<const volume::HydrometeorFields> prepared_fields_;
  std::shared_ptr<const Medium> medium_;
  Surroundings surroundings_;
  Camera camera_;
  std::optional<PathTracer> tracer_;
};

}  // namespace thunderhead::reference
