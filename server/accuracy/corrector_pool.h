// Light correctors for viewers of different scenes: each keeps what it has traced. Owns GL objects:
// use it on the context's thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "base/stopwatch.h"
#include "accuracy/light_corrector.h"
#include "gl/program.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::accuracy {

class CorrectorPool {
 public:
  // Each takes up to a hundred megabytes. One that was traced for within `busy_s` does not make
  // room for another scene's.
  explicit CorrectorPool(std::size_t most = 8, double busy_s = 3.0)
      : most_(most), busy_s_(busy_s), programs_(std::make_shared<gl::ProgramCache>()) {}

  // The one that serves the scene, looking as it does; null if there is none, or the scene has no
  // traced light.
  LightCorrector* Find(const scene::Scene& scene,
                       const std::shared_ptr<const volume::HydrometeorFields>& fields);

  // Goes a step on for the scene. RESOURCE_EXHAUSTED if all that there may be are busy.
  absl::StatusOr<LightProgress> Trace(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields);

 private:
  struct Kept {
    std::unique_ptr<LightCorrector> corrector;
    base::Stopwatch since_traced;
  };

  Kept* Serving(const scene::Scene& scene,
                const std::shared_ptr<const volume::HydrometeorFields>& fields);
  absl::Status MakeRoom();

  std::size_t most_;
  double busy_s_;
  std::shared_ptr<gl::ProgramCache> programs_;
  std::vector<Kept> kept_;
};

}  // namespace thunderhead::accuracy
