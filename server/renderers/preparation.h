// Work on the CPU that some scenes need once before drawing and that takes seconds, such as fitting
// metaballs. It runs outside the drawing thread, because it would otherwise block every session. It
// is safe to use from any thread and does not use GL.
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

  // Returns true if drawing `scene` from `fields` (of its storm and time) has nothing to wait for.
  virtual bool IsDone(const scene::Scene& scene, const Fields& fields) = 0;
  // Blocks until the preparation is done.
  virtual absl::Status Prepare(const scene::Scene& scene, const Fields& fields) = 0;
};

}  // namespace thunderhead::renderers
