// The current corrections of scenes' light by path tracing. One thread traces and publishes
// corrections (accuracy/corrector_pool.h), and drawing threads find them here. All functions are
// thread-safe.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>

#include "base/stopwatch.h"
#include "renderers/light_correction.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::accuracy {

// Returns true if light traced for the scene `traced` is valid for `scene`: only its camera,
// display and similar settings may differ.
bool SharesLight(const scene::Scene& traced, const scene::Scene& scene);

class TracedLights {
 public:
  using Fields = std::shared_ptr<const volume::HydrometeorFields>;

  struct Found {
    std::shared_ptr<const renderers::LightCorrection> correction;
    std::int64_t paths = 0;  // number of paths from which the correction was fitted
  };

  // Returns the correction for the scene, or nothing if there is none or the scene does not request
  // path-traced correction.
  std::optional<Found> Find(const scene::Scene& scene, const Fields& fields);

  // A scene whose light is being traced, and its correction. The tracing thread owns this object.
  class Entry {
   public:
    Entry(std::shared_ptr<TracedLights> lights, scene::Scene scene, Fields fields);
    ~Entry();
    Entry(const Entry&) = delete;
    Entry& operator=(const Entry&) = delete;

    void Publish(Found found);
    // Returns the milliseconds since the correction was last published or found by a drawing
    // thread.
    double UnusedMs() const;

   private:
    friend class TracedLights;

    const std::shared_ptr<TracedLights> lights_;
    const scene::Scene scene_;
    const Fields fields_;
    // Guarded by the lights' mutex.
    Found found_;
    base::Stopwatch since_used_;
  };

 private:
  std::mutex mutex_;
  std::list<Entry*> entries_;
};

}  // namespace thunderhead::accuracy
