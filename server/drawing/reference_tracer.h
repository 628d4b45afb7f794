// Refines sessions' pictures with the Monte Carlo reference on a separate thread, in short turns. A
// request replaces an earlier request of the same owner and ends it at once, so no requests queue.
// A new picture replaces an earlier one that was not taken.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/memory_budget.h"
#include "base/time_source.h"
#include "drawing/frame_source.h"
#include "drawing/reference_source.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::drawing {

// The newest picture that the Monte Carlo reference has traced for an owner.
struct ReferencePicture {
  picture::LinearPicture picture;
  delivery::Refinement refinement;
  double trace_ms = 0.0;  // time spent tracing since the request
  bool full_size = false;
};

class ReferenceTracer {
 public:
  // Each owner (a session) has its own source, whose buffers are reserved in `memory`. There are at
  // most `max_owners` owners. `on_picture` is called on the tracing thread when a picture can be
  // taken.
  ReferenceTracer(ReferenceSourceFactory make_source, std::size_t max_owners,
                  std::shared_ptr<base::MemoryBudget> memory, std::function<void()> on_picture,
                  const base::TimeSource& time = base::SteadyTime());
  // Ends tracing at once.
  ~ReferenceTracer();
  ReferenceTracer(const ReferenceTracer&) = delete;
  ReferenceTracer& operator=(const ReferenceTracer&) = delete;

  // Begins the owner's picture. RESOURCE_EXHAUSTED if there are too many owners.
  absl::Status Trace(const std::string& owner, std::shared_ptr<const scene::Scene> scene,
                     std::shared_ptr<const volume::HydrometeorFields> fields);
  // Takes the owner's newest picture, or the error that ended its tracing. Returns none if there is
  // neither.
  std::optional<absl::StatusOr<std::shared_ptr<const ReferencePicture>>> Take(
      const std::string& owner);
  // Stops tracing the owner's picture but keeps its source for the next picture.
  void Stop(const std::string& owner);
  // Stops tracing and frees the owner's source.
  void Forget(const std::string& owner);

 private:
  struct Job;
  using Found = std::optional<absl::StatusOr<std::shared_ptr<const ReferencePicture>>>;
  // The state of an owner. Only the tracing thread uses the source.
  struct Owned {
    std::shared_ptr<ReferenceSource> source;
    std::shared_ptr<base::MemoryReservation> reserved;  // for the source's buffers
    std::shared_ptr<Job> job;
    Found found;
  };

  void Run();
  std::shared_ptr<Job> NextJob();  // needs mutex_
  void Keep(Job& job, Found found, bool ended);

  const ReferenceSourceFactory make_source_;
  const std::size_t max_owners_;
  const std::shared_ptr<base::MemoryBudget> memory_;
  const std::function<void()> on_picture_;
  const base::TimeSource& time_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::map<std::string, Owned> owned_;
  std::string last_served_;
  std::thread thread_;
};

}  // namespace thunderhead::drawing
