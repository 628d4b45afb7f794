// A scene's picture by the reference that is begun over and over, coarse and fine, while the scene
// changes: what a change leaves as it was (the medium above all) is kept. Knows no sessions.
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
  // `peak_cut_deg` as MediumOptions has it.
  SceneTracer(double peak_cut_deg, const PathTracerOptions& options);

  // Begins a picture of `size_px`, whatever size the scene asks for, without any sample.
  absl::Status Begin(const scene::Scene& scene,
                     const std::shared_ptr<const volume::HydrometeorFields>& fields,
                     const glm::ivec2& size_px);

  // As PathTracer; needs a picture begun.
  RefineResult Refine(const RefineLimits& limits, const std::stop_token& stop);
  picture::LinearPicture Snapshot() const;

 private:
  absl::Status Prepare(const scene::Scene& scene,
                       const std::shared_ptr<const volume::HydrometeorFields>& fields);

  const double peak_cut_deg_;
  const PathTracerOptions options_;
  // What the kept parts were made from.
  std::optional<scene::Scene> prepared_scene_;
  std::weak_ptr<const volume::HydrometeorFields> prepared_fields_;
  std::shared_ptr<const Medium> medium_;
  Surroundings surroundings_;
  Camera camera_;
  std::optional<PathTracer> tracer_;
};

}  // namespace thunderhead::reference
