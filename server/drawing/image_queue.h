// Pictures requested outside any session, waiting to be drawn. Safe from any thread.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/fair_share.h"
#include "drawing/frame_source.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::drawing {

// Progress of tracing the light of a picture.
struct ImageProgress {
  double share = 0.0;  // of the required paths, 0 to 1
  std::int64_t traced_paths = 0;
  std::optional<double> estimated_error;  // of the picture with these paths
};

// Fields and camera of a picture.
struct ImageInput {
  std::shared_ptr<const volume::HydrometeorFields> fields;
  scene::Camera camera;  // the scene's, framed by the fields
};

// One picture at full quality, outside any session. Its fields are read when its turn comes, so
// that waiting jobs take no memory.
struct ImageJob {
  scene::Scene scene;
  std::function<absl::StatusOr<ImageInput>()> read;  // on a thread that may block
  // Called with the picture on a thread that may block; may take its pixels away.
  std::function<absl::Status(DisplayFrame&)> encode;
  std::shared_ptr<const std::atomic<bool>> cancelled;  // true ends it at the next piece
  // Called once, on the loop's thread or on the one that calls Add; must not block.
  std::function<void(absl::StatusOr<DisplayFrame>)> done;
  // If set, called on the loop's thread as more light is traced, and not after `done`; must not
  // block.
  std::function<void(const ImageProgress&)> on_progress = nullptr;
  // True if nobody waits for it: jobs that somebody waits for go first.
  bool gives_way = false;
  bool linear = false;         // also wanted as linear radiance
  double error_seconds = 0.0;  // of tracing, for its error to be measured
  // Maximum time for reading, drawing and encoding it, not counting the time spent waiting for
  // others, and the same since it was begun while it awaits light or its error; beyond it the job
  // ends with `too_long`.
  double max_work_ms = 1e15;
  absl::Status too_long = absl::OkStatus();
  // Who asked for it; all owners get equal shares of the drawing time. Empty: counts for nobody.
  std::string owner = "";
  // Set on admission: the scene with its decided setting, and the predicted time to draw it.
  std::optional<scene::Scene> decided = std::nullopt;
  double predicted_ms = 0.0;
};

class ImageQueue {
 public:
  // Limits of the pictures that may wait: in all, and of one owner.
  ImageQueue(std::size_t max_waiting, std::size_t max_waiting_each)
      : max_waiting_(max_waiting), max_waiting_each_(max_waiting_each) {}

  // False if the job was refused, as the queue is full, the owner has as many in it as one may, or
  // the server is stopping; `done` was called with the reason.
  bool Add(ImageJob job);
  // Asks `admit` of each job that came since the last call; those refused are done with the reason.
  void Admit(const std::function<absl::Status(ImageJob&)>& admit);
  // Takes the first admitted job for which `suits` is true, of the owner who has had the least
  // drawing time; one that gives way only if there is no other.
  std::optional<ImageJob> Take(const std::function<bool(const ImageJob&)>& suits);
  // Charges the owner the time that drawing has taken, instead of the predicted one.
  void Drew(const ImageJob& job, double milliseconds);
  // Drops cancelled jobs and calls their `done`.
  void DropCancelled();
  std::size_t Waiting() const;
  // Refuses all waiting and future jobs.
  void RefuseAll();

 private:
  std::size_t WaitingOf(const std::string& owner) const;  // needs mutex_
  // Takes the jobs for which `is` is true.
  std::deque<ImageJob> Extract(const std::function<bool(const ImageJob&)>& is);

  const std::size_t max_waiting_;
  const std::size_t max_waiting_each_;
  mutable std::mutex mutex_;
  std::deque<ImageJob> waiting_;
  base::FairShare owners_;
  bool refuses_ = false;
};

}  // namespace thunderhead::drawing
