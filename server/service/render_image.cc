#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "base/time_source.h"
#include "rpc_port/delivery_deadline.h"
#include "rpc_port/status_table.h"
#include "service/engine/limits.h"
#include "service/engine/requested_image.h"
#include "service/handlers.h"

namespace thunderhead::service {
namespace {

// Sends a picture as the response of a unary call.
class PictureReactor final : public grpc::ServerUnaryReactor, private ImageListener {
 public:
  PictureReactor(Engine& engine, grpc::CallbackServerContext* context, CallerRef caller,
                 const v1::RenderImageRequest& request, v1::RenderImageResponse& response)
      : caller_(std::move(caller)),
        response_(response),
        delivery_(context, engine.limits),
        requested_(engine, request, response, *this, Awaited::kByACall, caller_->identity().name) {}

  void Begin() { requested_.Begin(); }
  void OnCancel() override { requested_.Cancel(); }
  void OnDone() override { delete this; }

 private:
  void Ended(const absl::Status& status) override {
    caller_->Report("RenderImage", status);
    delivery_.Begin(response_.image().size());
    Finish(rpc_port::ToGrpcStatus(status));
  }

  const CallerRef caller_;
  const v1::RenderImageResponse& response_;
  rpc_port::DeliveryDeadline delivery_;
  RequestedImage requested_;
};

// Sends a picture as the last event of a stream. If the request has `in_chunks`, the bytes of the
// picture are sent in chunks before that event. There is at most one pending write. Progress that
// arrives during a write, or too soon after the last progress, is dropped because newer progress
// will follow.
class PictureStream final : public grpc::ServerWriteReactor<v1::RenderImageEvent>,
                            private ImageListener {
 public:
  PictureStream(Engine& engine, grpc::CallbackServerContext* context, CallerRef caller,
                const v1::RenderImageRequest& request)
      : caller_(std::move(caller)),
        in_chunks_(request.in_chunks()),
        time_(engine.sessions.time()),
        delivery_(context, engine.limits),
        requested_(engine, request, *image_.mutable_image(), *this, Awaited::kByACall,
                   caller_->identity().name) {}

  void Begin() { requested_.Begin(); }
  void OnCancel() override { requested_.Cancel(); }
  void OnDone() override { delete this; }

  void OnWriteDone(bool ok) override {
    delivery_.Taken();
    {
      const std::lock_guard lock(mutex_);
      writing_ = false;
      // If the picture is not finished, Ended will be called later. If the client has disconnected,
      // gRPC also calls OnCancel, which cancels the drawing.
      if (!end_.has_value()) return;
      if (!ok) end_ = grpc::Status(grpc::StatusCode::CANCELLED, "the client is gone");
    }
    WriteEnd();
  }

 private:
  static constexpr double kMinInterval_ms = 200.0;
  static constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

  void Progressed(const drawing::ImageProgress& progress) override {
    {
      const std::lock_guard lock(mutex_);
      const bool too_soon =
          told_at_.has_value() && base::MsSince(time_, *told_at_) < kMinInterval_ms;
      if (writing_ || too_soon) return;
      writing_ = true;
      told_at_ = time_.Now();
    }
    v1::RenderImageProgress& message = *progress_.mutable_progress();
    message.set_share(static_cast<float>(progress.share));
    message.set_traced_paths(static_cast<std::uint64_t>(progress.traced_paths));
    message.clear_estimated_error();
    if (progress.estimated_error.has_value()) {
      message.set_estimated_error(static_cast<float>(*progress.estimated_error));
    }
    delivery_.Begin(0);
    StartWrite(&progress_);
  }

  void Ended(const absl::Status& status) override {
    caller_->Report("RenderImageWithProgress", status);
    {
      const std::lock_guard lock(mutex_);
      end_ = rpc_port::ToGrpcStatus(status);
      if (writing_) return;  // OnWriteDone then writes the end
    }
    WriteEnd();
  }

  // Writes the next chunk, or ends the call after the last one. It must be called only while no
  // write is pending, and is called again after each chunk.
  void WriteEnd() {
    if (!end_->ok()) {
      delivery_.Begin(0);
      return Finish(*end_);
    }
    std::string& image = *image_.mutable_image()->mutable_image();
    if (in_chunks_ && sent_bytes_ < image.size()) {
      writing_ = true;
      progress_.set_chunk(image.substr(sent_bytes_, kChunkBytes));
      sent_bytes_ += progress_.chunk().size();
      delivery_.Begin(progress_.chunk().size());
      return StartWrite(&progress_);
    }
    if (in_chunks_) image.clear();
    delivery_.Begin(image.size());
    StartWriteAndFinish(&image_, grpc::WriteOptions(), *end_);
  }

  const CallerRef caller_;
  const bool in_chunks_;
  const base::TimeSource& time_;
  v1::RenderImageEvent image_;
  v1::RenderImageEvent progress_;  // progress or a chunk; gRPC reads it while `writing_`
  std::size_t sent_bytes_ = 0;     // size of the chunks sent
  std::mutex mutex_;
  bool writing_ = false;
  std::optional<base::TimeSource::Clock::time_point> told_at_;  // time of the last progress message
  std::optional<grpc::Status> end_;
  rpc_port::DeliveryDeadline delivery_;
  RequestedImage requested_;
};

}  // namespace

// Once a reactor has begun, gRPC owns it. If its start throws an exception, it is destroyed here,
// and the caller's pending call is no longer counted.
grpc::ServerUnaryReactor* RenderImage(Engine& engine, grpc::CallbackServerContext* context,
                                      const CallerRef& caller,
                                      const v1::RenderImageRequest* request,
                                      v1::RenderImageResponse* response) {
  auto reactor = std::make_unique<PictureReactor>(engine, context, caller, *request, *response);
  reactor->Begin();
  return reactor.release();
}

grpc::ServerWriteReactor<v1::RenderImageEvent>* RenderImageWithProgress(
    Engine& engine, grpc::CallbackServerContext* context, CallerRef caller,
    const v1::RenderImageRequest* request) {
  auto reactor = std::make_unique<PictureStream>(engine, context, std::move(caller), *request);
  reactor->Begin();
  return reactor.release();
}

}  // namespace thunderhead::service
