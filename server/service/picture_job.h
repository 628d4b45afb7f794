// One picture of the service, from its request to its bytes: for calls that wait for it, and for
// jobs.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "service/engine.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// The call that waits for a picture.
class PictureListener {
 public:
  // Progress of tracing light. Must not block.
  virtual void Progressed(const drawing::ImageProgress& /*progress*/) {}
  // Called once, and last. If `status` is OK the response is complete.
  virtual void Ended(const absl::Status& status) = 0;

 protected:
  ~PictureListener() = default;
};

// Those who wait for a picture: one without any lets others go before.
enum class Awaited { kByACall, kByNobody };

// Reads, draws and encodes a picture in a lane of the render loop, which ends it; everything passed
// to it must live until then. `owner` is the identity whose share of drawing it takes.
class PictureJob {
 public:
  PictureJob(Engine& engine, const v1::RenderImageRequest& request,
             v1::RenderImageResponse& response, PictureListener& listener, Awaited awaited,
             std::string owner = "")
      : engine_(engine),
        request_(request),
        response_(response),
        listener_(listener),
        awaited_(awaited),
        owner_(std::move(owner)) {}

  void Begin();
  // Ends it at its next piece. Safe from any thread.
  void Cancel();

 private:
  absl::Status CompleteScene();
  absl::StatusOr<drawing::ImageInput> Read();
  absl::Status EncodeTimed(drawing::DisplayFrame& picture);
  void Drawn(const absl::StatusOr<drawing::DisplayFrame>& picture);
  void End(const absl::Status& status);

  Engine& engine_;
  const Drain::Picture counted_{engine_.drain};
  const v1::RenderImageRequest& request_;
  v1::RenderImageResponse& response_;
  PictureListener& listener_;
  const Awaited awaited_;
  const std::string owner_;
  double encode_ms_ = 0.0;
  std::shared_ptr<const base::MemoryReservation> memory_;  // of the picture, until it is delivered
  std::shared_ptr<const volume::HydrometeorFields> fields_;  // of a picture as light, until then
  const std::shared_ptr<std::atomic<bool>> cancelled_ = std::make_shared<std::atomic<bool>>(false);
};

}  // namespace thunderhead::service
