// Work on the CPU that drawing some scenes needs once and that takes seconds, such as fitting
// metaballs. It is done beside the thread that draws, which would otherwise keep every session
// waiting. Safe from any thread. Knows no GL.
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

  // False if the scene never waits for anything, from whatever fields.
  virtual bool IsNeeded(const scene::Scene& scene) const = 0;

  // True if drawing `scene` from `fields` (of its storm and time) has nothing to wait for.
  virtual bool IsDone(const scene::Scene& scene, const Fields& fields) = 0;
  // Blocks until it has.
  virtual absl::Status Prepare(const scene::Scene& scene, const Fields& fields) = 0;
};

}  // namespace thunderhead::renderers
