#include <grpcpp/alarm.h>

#include <atomic>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "base/error_details.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "frame/image_codec.h"
#include "frame/png_text.h"
#include "picture/exr_file.h"
#include "scene/optical_depths.h"
#include "scene/view.h"
#include "service/camera_messages.h"
#include "service/handlers.h"
#include "service/limits_check.h"
#include "service/picture_texts.h"
#include "service/scene_messages.h"
#include "service/status_table.h"

namespace thunderhead::service {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

// The picture as light. Its estimated error is not known yet.
absl::StatusOr<std::string> EncodeLight(session::DisplayFrame& picture,
                                        const volume::HydrometeorFields& fields,
                                        const volume::StormInfo* storm,
                                        const v1::RenderImageResponse& response) {
  scene::AddOpticalDepths(ToScene(response.scene()), fields, &*picture.linear);
  picture::ExrAttributes attributes{.texts = {}, .numbers = {{kErrorText, kUnknown}}};
  if (storm != nullptr) attributes.texts = TextsOf(response, *storm);
  return picture::EncodeExr(*picture.linear, attributes);
}

// Takes the picture's pixels.
absl::Status Encode(session::DisplayFrame& picture, const v1::RenderImageRequest& request,
                    v1::RenderImageResponse& response) {
  const bool jpeg = request.format() == v1::IMAGE_FORMAT_JPEG;
  const int quality = static_cast<int>(response.scene().output().jpeg_quality());
  THUNDERHEAD_ASSIGN_OR_RETURN(
      *response.mutable_image(),
      jpeg ? frame::EncodeJpeg(picture.width_px, picture.height_px, picture.rgb, quality)
           : frame::EncodePng(picture.width_px, picture.height_px, picture.rgb));
  response.set_format(jpeg ? v1::IMAGE_FORMAT_JPEG : v1::IMAGE_FORMAT_PNG);
  picture.rgb = {};
  return absl::OkStatus();
}

void Describe(const session::DisplayFrame& picture, double encode_ms,
              v1::RenderImageResponse& response) {
  for (const scene::StageTime& time : picture.stages) ToMessage(time, *response.add_stages());
  ToMessage({scene::FrameStage::kEncode, encode_ms}, *response.add_stages());
  ToMessage(picture.modelled, *response.mutable_modelled());
  if (picture.accuracy.has_value()) ToMessage(*picture.accuracy, *response.mutable_accuracy());
}

// Writes into a PNG what it shows, and into an OpenEXR file what was not known when it was encoded.
// `storm` is null if it has gone since.
void AddTexts(const volume::StormInfo* storm, v1::RenderImageResponse& response) {
  if (response.format() == v1::IMAGE_FORMAT_EXR && response.has_accuracy()) {
    picture::SetExrNumber(kErrorText, response.accuracy().estimated_error(),
                          response.mutable_image());
  }
  if (response.format() != v1::IMAGE_FORMAT_PNG || storm == nullptr) return;
  response.set_image(frame::WithTexts(response.image(), TextsOf(response, *storm)));
}

// Errors of drawing are not about one field, so they name the whole scene.
absl::Status OfScene(const absl::Status& status) {
  return base::WithDetails(status, {.reason = "SCENE_NOT_DRAWN", .field = "scene"});
}

// The call that waits for a picture.
class PictureListener {
 public:
  // Progress of tracing light. Must not block.
  virtual void Progressed(const session::ImageProgress& /*progress*/) {}
  // Called once, and last. If `status` is OK the response is complete.
  virtual void Ended(const absl::Status& status) = 0;

 protected:
  ~PictureListener() = default;
};

// One picture: read, drawn and encoded in a lane of the render loop, which ends the job; everything
// passed to the job must live until then.
class PictureJob {
 public:
  PictureJob(Engine& engine, const v1::RenderImageRequest& request,
             v1::RenderImageResponse& response, PictureListener& listener)
      : engine_(engine), request_(request), response_(response), listener_(listener) {}

  void Begin() {
    if (const absl::Status late = counted_.Check(); !late.ok()) return End(late);
    if (const absl::Status wrong = CompleteScene(); !wrong.ok()) return End(wrong);
    deadline_.Set(std::chrono::system_clock::now() + engine_.limits.max_render_time,
                  [late = late_, cancelled = cancelled_, &wake = engine_.wake](bool rang) {
                    if (!rang) return;
                    *late = true;
                    *cancelled = true;
                    wake.Notify();
                  });
    engine_.loop.RenderImage(
        {ToScene(response_.scene()), [this] { return Read(); },
         [this](session::DisplayFrame& picture) { return EncodeTimed(picture); }, cancelled_,
         [this](const absl::StatusOr<session::DisplayFrame>& picture) { Drawn(picture); },
         [this](const session::ImageProgress& progress) { listener_.Progressed(progress); },
         request_.format() == v1::IMAGE_FORMAT_EXR});
  }

  void Cancel() {
    *cancelled_ = true;
    engine_.wake.Notify();
  }

 private:
  absl::Status CompleteScene() {
    THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request_));
    v1::Scene& scene = *response_.mutable_scene();
    scene = request_.scene();
    THUNDERHEAD_RETURN_IF_ERROR(PrepareScene(engine_.store, engine_.loop.Techniques(), scene));
    THUNDERHEAD_RETURN_IF_ERROR(CheckSize(engine_.limits, scene));
    if (!scene.rendering().has_reference()) return absl::OkStatus();
    return base::InvalidField("scene.rendering.reference",
                              "is given, which only sessions can show; for a file use "
                              "thunderhead render --renderer reference",
                              "TECHNIQUE_FOR_SESSIONS_ONLY");
  }

  absl::StatusOr<session::ImageInput> Read() {
    v1::Scene& scene = *response_.mutable_scene();
    THUNDERHEAD_ASSIGN_OR_RETURN(
        auto fields, ReadFields(engine_.store, scene.storm_id(),
                                static_cast<int>(scene.time_index()), "scene.storm_id"));
    FrameCondensate(scene, *fields);
    const scene::Scene value = ToScene(scene);
    ToMessage(scene::ViewOf(value, *fields), *response_.mutable_view());
    if (request_.format() == v1::IMAGE_FORMAT_EXR) fields_ = fields;
    return session::ImageInput{std::move(fields), value.camera};
  }

  absl::Status EncodeTimed(session::DisplayFrame& picture) {
    const base::Stopwatch stopwatch;
    response_.set_width_px(static_cast<std::uint32_t>(picture.width_px));
    response_.set_height_px(static_cast<std::uint32_t>(picture.height_px));
    if (request_.format() == v1::IMAGE_FORMAT_EXR) {
      const volume::StormInfoPtr storm = engine_.store.Find(response_.scene().storm_id());
      THUNDERHEAD_ASSIGN_OR_RETURN(*response_.mutable_image(),
                                   EncodeLight(picture, *fields_, storm.get(), response_));
      response_.set_format(v1::IMAGE_FORMAT_EXR);
      picture.linear.reset();
      picture.rgb = {};
      fields_.reset();
    } else {
      THUNDERHEAD_RETURN_IF_ERROR(Encode(picture, request_, response_));
    }
    encode_ms_ = stopwatch.ElapsedMs();
    return absl::OkStatus();
  }

  void Drawn(const absl::StatusOr<session::DisplayFrame>& picture) {
    if (!picture.ok()) return End(OfScene(picture.status()));
    Describe(*picture, encode_ms_, response_);
    AddTexts(engine_.store.Find(response_.scene().storm_id()).get(), response_);
    End(absl::OkStatus());
  }

  void End(const absl::Status& status) {
    listener_.Ended(absl::IsCancelled(status) && *late_
                        ? RenderedTooLong(engine_.limits.max_render_time)
                        : status);
  }

  Engine& engine_;
  const Drain::Picture counted_{engine_.drain};
  const v1::RenderImageRequest& request_;
  v1::RenderImageResponse& response_;
  PictureListener& listener_;
  double encode_ms_ = 0.0;
  std::shared_ptr<const volume::HydrometeorFields> fields_;  // of a picture as light, until then
  const std::shared_ptr<std::atomic<bool>> cancelled_ = std::make_shared<std::atomic<bool>>(false);
  const std::shared_ptr<std::atomic<bool>> late_ = std::make_shared<std::atomic<bool>>(false);
  grpc::Alarm deadline_;
};

// A picture as the response of a unary call.
class PictureReactor final : public grpc::ServerUnaryReactor, private PictureListener {
 public:
  PictureReactor(Engine& engine, CallerRef caller, const v1::RenderImageRequest& request,
                 v1::RenderImageResponse& response)
      : caller_(std::move(caller)), job_(engine, request, response, *this) {}

  void Begin() { job_.Begin(); }
  void OnCancel() override { job_.Cancel(); }
  void OnDone() override { delete this; }

 private:
  void Ended(const absl::Status& status) override {
    caller_->Report("RenderImage", status);
    Finish(ToGrpcStatus(status));
  }

  const CallerRef caller_;
  PictureJob job_;
};

// A picture as the last event of a stream. There is at most one pending write: progress that
// arrives meanwhile, or too soon after the last, is dropped, as newer progress will follow.
class PictureStream final : public grpc::ServerWriteReactor<v1::RenderImageEvent>,
                            private PictureListener {
 public:
  PictureStream(Engine& engine, CallerRef caller, const v1::RenderImageRequest& request)
      : caller_(std::move(caller)), job_(engine, request, *image_.mutable_image(), *this) {}

  void Begin() { job_.Begin(); }
  void OnCancel() override { job_.Cancel(); }
  void OnDone() override { delete this; }

  void OnWriteDone(bool /*ok: a client that is gone cancels as well*/) override {
    {
      const std::lock_guard lock(mutex_);
      writing_ = false;
      if (!end_.has_value()) return;
    }
    WriteEnd();
  }

 private:
  static constexpr double kMinInterval_ms = 200.0;

  void Progressed(const session::ImageProgress& progress) override {
    {
      const std::lock_guard lock(mutex_);
      const bool too_soon =
          since_progress_.has_value() && since_progress_->ElapsedMs() < kMinInterval_ms;
      if (writing_ || too_soon) return;
      writing_ = true;
      since_progress_.emplace();
    }
    v1::RenderImageProgress& message = *progress_.mutable_progress();
    message.set_share(static_cast<float>(progress.share));
    message.set_traced_paths(static_cast<std::uint64_t>(progress.traced_paths));
    message.clear_estimated_error();
    if (progress.estimated_error.has_value()) {
      message.set_estimated_error(static_cast<float>(*progress.estimated_error));
    }
    StartWrite(&progress_);
  }

  void Ended(const absl::Status& status) override {
    caller_->Report("RenderImageWithProgress", status);
    {
      const std::lock_guard lock(mutex_);
      end_ = ToGrpcStatus(status);
      if (writing_) return;  // OnWriteDone writes it
    }
    WriteEnd();
  }

  // Called once, when no write is pending.
  void WriteEnd() {
    if (!end_->ok()) return Finish(*end_);
    StartWriteAndFinish(&image_, grpc::WriteOptions(), *end_);
  }

  const CallerRef caller_;
  v1::RenderImageEvent image_;
  v1::RenderImageEvent progress_;  // gRPC reads it while `writing_`
  std::mutex mutex_;
  bool writing_ = false;
  std::optional<base::Stopwatch> since_progress_;
  std::optional<grpc::Status> end_;
  PictureJob job_;
};

}  // namespace

grpc::ServerUnaryReactor* RenderImage(Engine& engine, grpc::CallbackServerContext* /*context*/,
                                      const CallerRef& caller,
                                      const v1::RenderImageRequest* request,
                                      v1::RenderImageResponse* response) {
  auto* reactor = new PictureReactor(engine, caller, *request, *response);
  reactor->Begin();
  return reactor;
}

grpc::ServerWriteReactor<v1::RenderImageEvent>* RenderImageWithProgress(
    Engine& engine, grpc::CallbackServerContext* /*context*/, CallerRef caller,
    const v1::RenderImageRequest* request) {
  auto* reactor = new PictureStream(engine, std::move(caller), *request);
  reactor->Begin();
  return reactor;
}

}  // namespace thunderhead::service
