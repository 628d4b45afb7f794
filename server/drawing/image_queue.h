// A queue of pictures requested outside any session. Safe from any thread.
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
  double share = 0.0;  // traced share of the required paths, 0 to 1
  std::int64_t traced_paths = 0;
  std::optional<double> estimated_error;  // estimated error of the picture with these paths
};

// The fields and the camera of a picture.
struct ImageInput {
  std::shared_ptr<const volume::HydrometeorFields> fields;
  scene::Camera camera;  // the scene's camera, framed by the fields
};

// One picture at full quality, outside any session. Its fields are read when its turn comes, so
// that waiting jobs hold no fields in memory.
struct ImageJob {
  scene::Scene scene;
  std::function<absl::StatusOr<ImageInput>()> read;  // called on a thread that may block
  // Called with the picture on a thread that may block. It may move the pixels out.
  std::function<absl::Status(DisplayFrame&)> encode;
  std::shared_ptr<const std::atomic<bool>> cancelled;  // true ends the job at its next piece
  // Called once, on the loop's thread or on the thread that calls Add; must not block.
  std::function<void(absl::StatusOr<DisplayFrame>)> done;
  // If set, called on the loop's thread when more light is traced, but never after `done`; must not
  // block.
  std::function<void(const ImageProgress&)> on_progress = nullptr;
  // Set for background jobs: no client waits for them, so jobs with a waiting client go first.
  bool gives_way = false;
  bool linear = false;         // the linear radiance is requested as well
  double error_seconds = 0.0;  // maximum tracing time for measuring the picture's error
  // Maximum time for reading, drawing and encoding, without the time spent waiting for other work.
  // The same limit applies to the time since the start while the job waits for light or its error.
  // A job that exceeds it ends with `too_long`.
  double max_work_ms = 1e15;
  absl::Status too_long = absl::OkStatus();
  // The identity that requested it. All owners get equal shares of the drawing time. Empty: no
  // owner.
  std::string owner = "";
  // Set on admission: the scene with its decided setting, and its predicted drawing time.
  std::optional<scene::Scene> decided = std::nullopt;
  double predicted_ms = 0.0;
};

class ImageQueue {
 public:
  // The maximum numbers of waiting pictures: in all, and of one owner.
  ImageQueue(std::size_t max_waiting, std::size_t max_waiting_each)
      : max_waiting_(max_waiting), max_waiting_each_(max_waiting_each) {}

  // Adds a job. Returns false after calling `done` with the reason if the queue is full, the owner
  // has too many jobs in it, or the server is stopping.
  bool Add(ImageJob job);
  // Calls `admit` for each job added since the last call. Refused jobs are done with its error.
  void Admit(const std::function<absl::Status(ImageJob&)>& admit);
  // Takes the first admitted job for which `suits` is true, of the owner that has used the least
  // drawing time. Takes a background job only if there is no other.
  std::optional<ImageJob> Take(const std::function<bool(const ImageJob&)>& suits);
  // Charges the owner for the actual drawing time instead of the predicted time.
  void Drew(const ImageJob& job, double milliseconds);
  // Drops cancelled jobs and calls their `done`.
  void DropCancelled();
  std::size_t Waiting() const;
  // Refuses all waiting and future jobs.
  void RefuseAll();

 private:
  std::size_t WaitingOf(const std::string& owner) const;  // needs mutex_
  // Removes and returns the jobs for which `is` is true.
  std::deque<ImageJob> Extract(const std::function<bool(const ImageJob&)>& is);

  const std::size_t max_waiting_;
  const std::size_t max_waiting_each_;
  mutable std::mutex mutex_;
  std::deque<ImageJob> waiting_;
  base::FairShare owners_;
  bool refuses_ = false;
};

}  // namespace thunderhead::drawing
