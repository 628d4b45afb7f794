// Work on the CPU that some scenes need once before they are drawn, such as fitting metaballs. It
// takes seconds and would block every session in the drawing thread, so it runs in other threads.
// The class is safe to use from any thread and does not use GL.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::renderers {

class Preparation {
 public:
  using Fields = std::shared_ptr<const volume::HydrometeorFields>;

  virtual ~Preparation() = default;

  // Returns false if the scene never needs preparation, whatever its fields.
  virtual bool IsNeeded(const scene::Scene& scene) const = 0;

  // Returns true if `scene` can be drawn at once from `fields`, which are those of its storm and
  // time.
  virtual bool IsDone(const scene::Scene& scene, const Fields& fields) = 0;
  // Blocks until the preparation is done.
  virtual absl::Status Prepare(const scene::Scene& scene, const Fields& fields) = 0;
};

}  // namespace thunderhead::renderers
