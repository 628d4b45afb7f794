// Light correctors for several scenes in view at once; each keeps its traced light, and publishes
// corrections for threads that draw. Owns GL objects: use it on the context's thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <utility>

#include "absl/status/statusor.h"
#include "accuracy/light_corrector.h"
#include "accuracy/setting.h"
#include "accuracy/traced_lights.h"
#include "base/memory_budget.h"
#include "base/stopwatch.h"
#include "gl/program.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::accuracy {

class CorrectorPool {
 public:
  // Programs are linked in `programs`. At most `max_correctors`, as each takes up to a hundred
  // megabytes, besides the storm's extinction, which is reserved in `memory`. One that was traced
  // within `busy_s`, or that is claimed, is not replaced; one that was not used for `unused_s` goes
  // with the next call.
  explicit CorrectorPool(
      std::shared_ptr<gl::ProgramCache> programs,
      std::shared_ptr<TracedLights> lights = std::make_shared<TracedLights>(),
      std::shared_ptr<base::MemoryBudget> memory = base::MemoryBudget::Unlimited(),
      std::size_t max_correctors = 8, double busy_s = 3.0, double unused_s = 300.0)
      : memory_(std::move(memory)),
        max_correctors_(max_correctors),
        busy_s_(busy_s),
        unused_s_(unused_s),
        programs_(std::move(programs)),
        lights_(std::move(lights)) {}

  // Null if there is none for the scene, or the scene has no traced light.
  const LightCorrector* Find(const scene::Scene& scene,
                             const std::shared_ptr<const volume::HydrometeorFields>& fields);

  // Traces one step for the scene. RESOURCE_EXHAUSTED if there are `max_correctors` already and all
  // are busy or claimed, or their storms leave no memory for another. `claim`, which may be null,
  // is given a claim on the scene's light. The correction is published now and then, and once
  // `wanted_paths` are traced.
  absl::StatusOr<LightProgress> Trace(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      LightClaim* claim = nullptr, std::int64_t wanted_paths = kTracedPaths);

  // Drops the one that was traced longest ago, unless all are busy or claimed; false then. May be
  // called while another is traced.
  bool DropOldest();

 private:
  struct Kept {
    base::MemoryReservation reserved;
    std::unique_ptr<LightCorrector> corrector;
    std::unique_ptr<TracedLights::Entry> published;
    base::Stopwatch since_traced;
    base::Stopwatch since_published;
    std::int64_t published_paths = 0;
    LightClaim claim = std::make_shared<int>();  // of which others may have copies

    bool IsClaimed() const { return claim.use_count() > 1; }
  };

  Kept* Serving(const scene::Scene& scene,
                const std::shared_ptr<const volume::HydrometeorFields>& fields);
  std::list<Kept>::iterator OldestIdle();
  absl::Status MakeRoom();
  // Drops idle correctors, the oldest first, where their storms leave no room for another.
  absl::StatusOr<base::MemoryReservation> Reserve(std::size_t bytes);
  static void Publish(Kept& kept, std::int64_t wanted_paths);
  void DropUnused();

  std::shared_ptr<base::MemoryBudget> memory_;
  std::size_t max_correctors_;
  double busy_s_;
  double unused_s_;
  std::shared_ptr<gl::ProgramCache> programs_;
  std::shared_ptr<TracedLights> lights_;
  std::list<Kept> kept_;
};

}  // namespace thunderhead::accuracy
