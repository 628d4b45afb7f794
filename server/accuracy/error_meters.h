// Error meters for several scenes at rest, which improve step by step. Each meter gets its scene's
// picture with the current light and traces some of its pixels. Used on one thread; the caller does
// the drawing.
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
  // None while too few paths are traced for a useful interval.
  std::optional<MeasuredError> error;
  double traced_s = 0.0;
  // True if more paths are not worthwhile while the light stays the same, or if nothing can be
  // measured.
  bool ended = false;

  bool HasTraced(double wanted_s) const { return ended || traced_s >= wanted_s; }
  bool operator==(const ErrorProgress&) const = default;
};

// Returns the scene of a picture that can be compared with the reference. It is `scene` at full
// quality and in its own size, without features that the reference does not show in the same way:
// turbulent detail and range rings.
scene::Scene MeasuredScene(const scene::Scene& scene);

// Returns false for fields with uneven ground, because the reference does not show it.
bool IsMeasurable(const volume::HydrometeorFields& fields);

class ErrorMeters {
 public:
  using Fields = std::shared_ptr<const volume::HydrometeorFields>;
  using Draw = std::function<absl::StatusOr<picture::LinearPicture>(const scene::Scene& measured)>;

  // There are at most `max_meters`, because each holds a copy of its storm's extinction, which is
  // reserved in `memory`. A meter that was used within `busy_s` is not replaced. A meter that was
  // not used for `unused_s` is dropped at the next call.
  explicit ErrorMeters(std::shared_ptr<base::MemoryBudget> memory = base::MemoryBudget::Unlimited(),
                       std::size_t max_meters = 8, double busy_s = 3.0, double unused_s = 60.0,
                       reference::MakesTracer makes_tracer = reference::TracerOnProcessors)
      : memory_(std::move(memory)),
        max_meters_(max_meters),
        busy_s_(busy_s),
        unused_s_(unused_s),
        makes_tracer_(std::move(makes_tracer)) {}

  // Does one step for the scene. Draws with `draw` if the scene is new, or if many more paths
  // (`light_paths`) correct its light than before. Otherwise traces, unless the measurement has
  // ended or `wanted` fails. RESOURCE_EXHAUSTED if too many other scenes are being measured or
  // memory does not suffice for another storm.
  absl::StatusOr<ErrorProgress> Step(const scene::Scene& scene, const Fields& fields,
                                     std::int64_t light_paths, const Draw& draw,
                                     const reference::IsWanted& wanted = nullptr);

  // Drops the meter that was used longest ago. Returns false if all are busy.
  bool DropOldest();

 private:
  struct Kept {
    scene::Scene scene;
    Fields fields;
    base::MemoryReservation reserved;
    std::unique_ptr<ErrorMeter> meter;
    std::optional<std::int64_t> drawn_paths;  // paths behind the measured picture's light
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
