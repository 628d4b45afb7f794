// Error meters for several scenes at rest, which get better step by step: each draws its scene's
// picture as the light stands, and traces some of its pixels. Used on one thread; drawing is left
// to the caller.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <utility>

#include "absl/status/statusor.h"
#include "accuracy/error_meter.h"
#include "base/memory_budget.h"
#include "base/stopwatch.h"
#include "picture/linear_picture.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::accuracy {

struct ErrorProgress {
  // None while too few paths are traced for an interval that says anything.
  std::optional<MeasuredError> error;
  double traced_s = 0.0;
  // True if more paths are not worth it while the light stays as it is, or nothing can be measured.
  bool ended = false;

  bool HasTraced(double wanted_s) const { return ended || traced_s >= wanted_s; }
  bool operator==(const ErrorProgress&) const = default;
};

// A picture that the reference can be compared with: `scene` at full quality and in its own size,
// but without what the reference leaves out or shows otherwise: turbulent detail and rings of
// distance.
scene::Scene MeasuredScene(const scene::Scene& scene);

// False where pictures show what the reference does not: uneven ground.
bool IsMeasurable(const volume::HydrometeorFields& fields);

class ErrorMeters {
 public:
  using Fields = std::shared_ptr<const volume::HydrometeorFields>;
  using Draw = std::function<absl::StatusOr<picture::LinearPicture>(const scene::Scene& measured)>;

  // At most `max_meters`, as each has a copy of its storm's extinction, reserved in `memory`. One
  // that was used within `busy_s` is not replaced; one that was not for `unused_s` goes with the
  // next call.
  explicit ErrorMeters(std::shared_ptr<base::MemoryBudget> memory = base::MemoryBudget::Unlimited(),
                       std::size_t max_meters = 8, double busy_s = 3.0, double unused_s = 60.0,
                       reference::MakesTracer makes_tracer = reference::TracerOnProcessors)
      : memory_(std::move(memory)),
        max_meters_(max_meters),
        busy_s_(busy_s),
        unused_s_(unused_s),
        makes_tracer_(std::move(makes_tracer)) {}

  // A step for the scene: draws with `draw` if it is new or its light is corrected by many more
  // paths than it was (`light_paths`), and else traces, unless it has ended or is not `wanted`.
  // RESOURCE_EXHAUSTED if too many other scenes are being measured, or there is no memory for
  // another storm.
  absl::StatusOr<ErrorProgress> Step(const scene::Scene& scene, const Fields& fields,
                                     std::int64_t light_paths, const Draw& draw,
                                     const reference::IsWanted& wanted = nullptr);

  // Drops the one that was used longest ago, unless all are busy; false then.
  bool DropOldest();

 private:
  struct Kept {
    scene::Scene scene;
    Fields fields;
    base::MemoryReservation reserved;
    std::unique_ptr<ErrorMeter> meter;
    std::optional<std::int64_t> drawn_paths;  // that corrected the light of the measured picture
    base::Stopwatch since_used;
  };

  absl::StatusOr<Kept*> For(const scene::Scene& measured, const Fields& fields);
  void DropUnused();

  std::shared_ptr<base::MemoryBudget> memory_;
  std::size_t max_meters_;
  double busy_s_;
  double unused_s_;
  reference::MakesTracer makes_tracer_;
  std::list<Kept> kept_;
};

}  // namespace thunderhead::accuracy
