// A pool of light correctors for several scenes that are viewed at the same time. Each corrector
// keeps the light that it has traced for its scene, and publishes corrections for drawing threads.
// The pool owns GL objects, so it must be used on the context's thread.
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
  // `programs` caches linked shader programs. There are at most `max_correctors` correctors,
  // because each takes up to a hundred megabytes in addition to the storm's extinction. The memory
  // for the extinction is reserved in `memory`. A corrector that was used for tracing within the
  // last `busy_s` seconds, or that is claimed, is not replaced. A corrector that was not used for
  // `unused_s` seconds is dropped at the next call.
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

  // Returns the corrector for the scene, or null if there is none or the scene does not request
  // path-traced correction.
  const LightCorrector* Find(const scene::Scene& scene,
                             const std::shared_ptr<const volume::HydrometeorFields>& fields);

  // Traces one step for the scene. Returns RESOURCE_EXHAUSTED if there are `max_correctors`
  // correctors and all are busy or claimed, or if there is no memory for another storm. It also
  // returns the errors of LightCorrector::Create and LightCorrector::Step. If the scene has no
  // light to trace (TracesLight), it does nothing and returns a progress without paths. If `claim`
  // is not null, it receives a claim on the scene's light, which keeps the corrector in the pool
  // while a copy of the claim exists. The correction is published at intervals, and when
  // `wanted_paths` paths are traced.
  absl::StatusOr<LightProgress> Trace(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      LightClaim* claim = nullptr, std::int64_t wanted_paths = kTracedPaths);

  // Drops the corrector that was least recently used for tracing. Returns false if all correctors
  // are busy or claimed. May be called while another corrector is tracing.
  bool DropOldest();

 private:
  struct Kept {
    base::MemoryReservation reserved;
    std::unique_ptr<LightCorrector> corrector;
    std::unique_ptr<TracedLights::Entry> published;
    base::Stopwatch since_traced;
    base::Stopwatch since_published;
    std::int64_t published_paths = 0;
    LightClaim claim = std::make_shared<int>();  // its copies belong to callers of Trace()

    bool IsClaimed() const { return claim.use_count() > 1; }
  };

  Kept* Serving(const scene::Scene& scene,
                const std::shared_ptr<const volume::HydrometeorFields>& fields);
  std::list<Kept>::iterator OldestIdle();
  absl::Status MakeRoom();
  // Reserves memory. If there is not enough, drops idle correctors first, the least recently used
  // first.
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
