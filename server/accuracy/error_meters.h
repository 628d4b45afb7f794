// Error meters for several scenes that are at rest (neither scene nor camera changes). The measured
// errors become more precise with each step. Each meter receives a picture of its scene and traces
// some of its pixels. The class must be used on one thread. The caller draws the pictures.
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
  // Nothing while too few paths are traced for a useful confidence interval.
  std::optional<MeasuredError> error;
  double traced_s = 0.0;
  // True if tracing need not continue: the error is precise enough, the longest time of tracing has
  // passed, or nothing can be measured. It may become false again when path tracing has corrected
  // the light and the picture was therefore drawn again.
  bool ended = false;

  bool HasTraced(double wanted_s) const { return ended || traced_s >= wanted_s; }
  bool operator==(const ErrorProgress&) const = default;
};

// Returns a version of `scene` whose picture can be compared with the reference. It has full
// quality and the same size. It has no turbulent detail, which the reference does not show. It has
// no borders and distance rings, which the reference draws differently.
scene::Scene MeasuredScene(const scene::Scene& scene);

// Returns false for fields with uneven ground, because the reference does not show relief.
bool IsMeasurable(const volume::HydrometeorFields& fields);

class ErrorMeters {
 public:
  using Fields = std::shared_ptr<const volume::HydrometeorFields>;
  using Draw = std::function<absl::StatusOr<picture::LinearPicture>(const scene::Scene& measured)>;

  // There are at most `max_meters` meters, because each holds a copy of its storm's extinction. The
  // memory for these copies is reserved in `memory`. A meter that was used within the last `busy_s`
  // seconds is not replaced. A meter that was not used for `unused_s` seconds is dropped at the
  // next call.
  explicit ErrorMeters(std::shared_ptr<base::MemoryBudget> memory = base::MemoryBudget::Unlimited(),
                       std::size_t max_meters = 8, double busy_s = 3.0, double unused_s = 60.0,
                       reference::MakesTracer makes_tracer = reference::TracerOnProcessors)
      : memory_(std::move(memory)),
        max_meters_(max_meters),
        busy_s_(busy_s),
        unused_s_(unused_s),
        makes_tracer_(std::move(makes_tracer)) {}

  // Does one step for the scene. `light_paths` is the number of paths that correct the scene's
  // light now. If the scene is new, or if this number has grown much, the step draws a picture by
  // `draw`. Otherwise it traces paths, unless the measurement has ended. If the fields cannot be
  // measured (IsMeasurable), the measurement ends at once. Returns the errors of `draw` and
  // `wanted`, and RESOURCE_EXHAUSTED if too many other scenes are being measured, or if there is no
  // memory for another storm.
  absl::StatusOr<ErrorProgress> Step(const scene::Scene& scene, const Fields& fields,
                                     std::int64_t light_paths, const Draw& draw,
                                     const reference::IsWanted& wanted = nullptr);

  // Drops the least recently used meter. Returns false if all meters are busy.
  bool DropOldest();

 private:
  struct Kept {
    scene::Scene scene;
    Fields fields;
    base::MemoryReservation reserved;
    std::unique_ptr<ErrorMeter> meter;
    std::optional<std::int64_t> drawn_paths;  // number of paths that corrected the light of the
                                              // measured picture
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
