// One picture outside sessions, from its request to its bytes. It serves calls that wait for the
// picture (RenderImage), and render jobs.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "service/engine/engine.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// The recipient of a picture and its progress.
class ImageListener {
 public:
  // Reports the progress of path tracing. It must not block.
  virtual void Progressed(const drawing::ImageProgress& /*progress*/) {}
  // Reports the end. It is called once, as the last call. If `status` is OK, the response is
  // complete.
  virtual void Ended(const absl::Status& status) = 0;

 protected:
  ~ImageListener() = default;
};

// Says whether a call waits for the picture. Pictures with a waiting call are drawn first.
enum class Awaited { kByACall, kByNobody };

// Reads, draws and encodes a picture by a worker of the render loop. All arguments must live until
// ImageListener::Ended is called. `owner` is the identity to whose share of drawing time the
// picture counts.
class RequestedImage {
 public:
  RequestedImage(Engine& engine, const v1::RenderImageRequest& request,
                 v1::RenderImageResponse& response, ImageListener& listener, Awaited awaited,
                 std::string owner = "")
      : engine_(engine),
        request_(request),
        response_(response),
        listener_(listener),
        awaited_(awaited),
        owner_(std::move(owner)) {}

  void Begin();
  // Cancels the picture before its next piece of work. Safe to call from any thread.
  void Cancel();

 private:
  absl::Status CompleteScene();
  absl::StatusOr<drawing::ImageInput> Read();
  absl::Status EncodeTimed(drawing::DisplayFrame& picture);
  void Drawn(const absl::StatusOr<drawing::DisplayFrame>& picture);
  void End(const absl::Status& status);

  Engine& engine_;
  const rpc_port::Drain::Picture counted_{engine_.drain};
  const v1::RenderImageRequest& request_;
  v1::RenderImageResponse& response_;
  ImageListener& listener_;
  const Awaited awaited_;
  const std::string owner_;
  double encode_ms_ = 0.0;
  // The reservation of the picture's memory, held until the picture is delivered.
  std::shared_ptr<const base::MemoryReservation> memory_;
  // The fields of a picture with linear radiance, kept until the picture is encoded.
  std::shared_ptr<const volume::HydrometeorFields> fields_;
  const std::shared_ptr<std::atomic<bool>> cancelled_ = std::make_shared<std::atomic<bool>>(false);
};

}  // namespace thunderhead::service
