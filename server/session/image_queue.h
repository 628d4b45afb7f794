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

#include "absl/status/statusor.h"
#include "scene/scene.h"
#include "session/frame_source.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::session {

// Progress of tracing the light of a picture.
struct ImageProgress {
  double share = 0.0;  // of the required paths, 0 to 1
  std::int64_t traced_paths = 0;
  std::optional<double> estimated_error;  // of the picture with these paths
};

// What a picture needs once before it is drawn (renderers::Preparation), done on another thread.
struct ImagePreparation {
  std::atomic<bool> ended{false};  // set last
  absl::Status status;
  double milliseconds = 0.0;
};

// One picture at full quality, outside any session.
struct ImageJob {
  scene::Scene scene;
  std::shared_ptr<const volume::HydrometeorFields> fields;
  std::shared_ptr<const std::atomic<bool>> cancelled;  // true drops the job while it waits
  // Called once, on the loop's thread or on the one that calls Add; must not block.
  std::function<void(absl::StatusOr<DisplayFrame>)> done;
  // If set, called on the loop's thread after each step of tracing light, and not after `done`;
  // must not block.
  std::function<void(const ImageProgress&)> on_progress = nullptr;
  // The scene with its decided setting; none before the first turn.
  std::optional<scene::Scene> decided = std::nullopt;
  // Of the decided scene; null while it has not begun, or is not needed.
  std::shared_ptr<const ImagePreparation> preparation = nullptr;
  // On the light that it waits for.
  accuracy::LightClaim light = nullptr;
};

class ImageQueue {
 public:
  explicit ImageQueue(std::size_t max_waiting) : max_waiting_(max_waiting) {}

  // False if the job was refused, as the queue is full or the server is stopping; `done` was called
  // with the reason.
  bool Add(ImageJob job);
  // Queues a job that was begun but is not done behind the others.
  void PutBack(ImageJob job);
  // The number of waiting jobs.
  std::size_t Count();
  // Takes the next job; drops cancelled ones and calls their `done`.
  std::optional<ImageJob> Take();
  // Refuses all waiting and future jobs.
  void RefuseAll();

 private:
  const std::size_t max_waiting_;
  std::mutex mutex_;
  std::deque<ImageJob> waiting_;
  bool refuses_ = false;
};

}  // namespace thunderhead::session
