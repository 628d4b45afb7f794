// A queue of single pictures that were requested outside any session. Safe from any thread.
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
  double share = 0.0;  // traced paths divided by the required paths, 0 to 1
  std::int64_t traced_paths = 0;
  // Estimated error of the picture if it were drawn with the paths traced so far.
  std::optional<double> estimated_error;
};

// The fields of a picture's storm, and the picture's camera.
struct ImageInput {
  std::shared_ptr<const volume::HydrometeorFields> fields;
  scene::Camera camera;  // the scene's camera with absent settings derived from the fields
};

// One picture at full quality, outside any session. Its fields are read only when it is its turn,
// so that waiting jobs hold no fields in memory.
struct ImageJob {
  scene::Scene scene;
  std::function<absl::StatusOr<ImageInput>()> read;  // called on a thread that may block
  // Encodes the picture. Called on a thread that may block; it may move the pixels out of its
  // argument.
  std::function<absl::Status(DisplayFrame&)> encode;
  std::shared_ptr<const std::atomic<bool>> cancelled;  // true ends the job before its next piece
  // Called once with the outcome, on the render loop's thread or on the thread that calls Add. It
  // must not block.
  std::function<void(absl::StatusOr<DisplayFrame>)> done;
  // If set, called on the render loop's thread when more light was traced, but never after `done`.
  // It must not block.
  std::function<void(const ImageProgress&)> on_progress = nullptr;
  // True for background jobs. No client waits for these, so jobs with a waiting client are drawn
  // first.
  bool gives_way = false;
  bool linear = false;         // also return the linear radiance
  double error_seconds = 0.0;  // maximum tracing time for measuring the picture's error
  // Maximum time for reading, drawing and encoding, without the time spent waiting for other work.
  // While the job waits for light or for its error, the same limit applies to the time since its
  // start. A job that exceeds the limit ends with the error `too_long`.
  double max_work_ms = 1e15;
  absl::Status too_long = absl::OkStatus();
  // The identity that requested the picture. All owners get equal shares of the drawing time. Empty
  // if the picture has no owner.
  std::string owner = "";
  // Set on admission: the scene with its decided setting, and its predicted drawing time.
  std::optional<scene::Scene> decided = std::nullopt;
  double predicted_ms = 0.0;
  // Set when the job is taken: the predicted drawing time that its owner was charged.
  double charged_ms = 0.0;
};

class ImageQueue {
 public:
  // `max_waiting` is the maximum number of waiting pictures, `max_waiting_each` the maximum of one
  // owner.
  ImageQueue(std::size_t max_waiting, std::size_t max_waiting_each)
      : max_waiting_(max_waiting), max_waiting_each_(max_waiting_each) {}

  // Adds a job. If the queue is full, the owner has too many jobs in it or the server is stopping,
  // calls the job's `done` with the reason and returns false.
  bool Add(ImageJob job);
  // Calls `admit` for each job added since the last call. If it returns an error, the job ends with
  // that error.
  void Admit(const std::function<absl::Status(ImageJob&)>& admit);
  // Takes the first admitted job for which `suits` is true, of the owner that has used the least
  // drawing time. Takes a background job only if no other job suits.
  std::optional<ImageJob> Take(const std::function<bool(const ImageJob&)>& suits);
  // Replaces the predicted drawing time, which was charged to the owner, by the actual time.
  // Without a time, as for a picture that failed, the predicted time counts as used.
  void Settle(const ImageJob& job, std::optional<double> milliseconds);
  // Removes cancelled jobs and calls their `done`.
  void DropCancelled();
  std::size_t Waiting() const;
  // Refuses all waiting and future jobs.
  void RefuseAll();

 private:
  std::size_t WaitingOf(const std::string& owner) const;  // needs mutex_
  // Removes and returns the jobs for which `is` returns true.
  std::deque<ImageJob> Extract(const std::function<bool(const ImageJob&)>& is);

  const std::size_t max_waiting_;
  const std::size_t max_waiting_each_;
  mutable std::mutex mutex_;
  std::deque<ImageJob> waiting_;
  base::FairShare owners_;
  bool refuses_ = false;
};

}  // namespace thunderhead::drawing
