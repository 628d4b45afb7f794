// Refines sessions' pictures towards the truth on a thread of its own, beside the one that draws, a
// short while each in turn. What is asked for replaces what was asked for before and ends it at
// once, so nothing queues; a picture that nobody took is replaced by the next.
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
#include "scene/scene.h"
#include "session/frame_source.h"
#include "session/truth_source.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::session {

// As far as it has come.
struct TruthPicture {
  picture::LinearPicture picture;
  Refinement refinement;
  double trace_ms = 0.0;  // since it was asked for
  bool full_size = false;
};

class TruthTracer {
 public:
  // Each owner has a source of its own, which keeps what it made; `most_owners` bounds their
  // memory. `on_picture` is called on the tracing thread when a picture can be taken.
  TruthTracer(TruthSourceFactory make_source, std::size_t most_owners,
              std::function<void()> on_picture);
  // Ends what is traced, at once.
  ~TruthTracer();
  TruthTracer(const TruthTracer&) = delete;
  TruthTracer& operator=(const TruthTracer&) = delete;

  // Begins the owner's picture; RESOURCE_EXHAUSTED if there are too many owners.
  absl::Status Trace(const std::string& owner, std::shared_ptr<const scene::Scene> scene,
                     std::shared_ptr<const volume::HydrometeorFields> fields);
  // The owner's newest picture, once, or why there is none.
  std::optional<absl::StatusOr<std::shared_ptr<const TruthPicture>>> Take(const std::string& owner);
  // The owner's picture is not traced on; what was made for it is kept for the next.
  void Stop(const std::string& owner);
  // The owner wants nothing any more.
  void Forget(const std::string& owner);

 private:
  struct Job;
  using Found = std::optional<absl::StatusOr<std::shared_ptr<const TruthPicture>>>;
  // What an owner has. Its source is used by the tracing thread only.
  struct Owned {
    std::shared_ptr<TruthSource> source;
    std::shared_ptr<Job> job;
    Found found;
  };

  void Run();
  std::shared_ptr<Job> NextJob();  // needs mutex_
  void Keep(Job& job, Found found, bool ended);

  const TruthSourceFactory make_source_;
  const std::size_t most_owners_;
  const std::function<void()> on_picture_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::map<std::string, Owned> owned_;
  std::string last_served_;
  std::thread thread_;
};

}  // namespace thunderhead::session
