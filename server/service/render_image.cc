#include <atomic>
#include <memory>
#include <utility>

#include "base/error_details.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "frame/image_codec.h"
#include "service/camera_messages.h"
#include "service/finished.h"
#include "service/handlers.h"
#include "service/limits_check.h"
#include "service/scene_messages.h"

namespace thunderhead::service {
namespace {

absl::Status Encode(const session::DisplayFrame& picture, const v1::RenderImageRequest& request,
                    v1::RenderImageResponse& response) {
  const base::Stopwatch stopwatch;
  const bool jpeg = request.format() == v1::IMAGE_FORMAT_JPEG;
  const int quality = static_cast<int>(response.scene().output().jpeg_quality());
  THUNDERHEAD_ASSIGN_OR_RETURN(
      *response.mutable_image(),
      jpeg ? frame::EncodeJpeg(picture.width_px, picture.height_px, picture.rgb, quality)
           : frame::EncodePng(picture.width_px, picture.height_px, picture.rgb));
  response.set_format(jpeg ? v1::IMAGE_FORMAT_JPEG : v1::IMAGE_FORMAT_PNG);
  response.set_width_px(static_cast<std::uint32_t>(picture.width_px));
  response.set_height_px(static_cast<std::uint32_t>(picture.height_px));
  for (const scene::StageTime& time : picture.stages) ToMessage(time, *response.add_stages());
  ToMessage({scene::FrameStage::kEncode, stopwatch.ElapsedMs()}, *response.add_stages());
  ToMessage(picture.modelled, *response.mutable_modelled());
  if (picture.accuracy.has_value()) ToMessage(*picture.accuracy, *response.mutable_accuracy());
  return absl::OkStatus();
}

// What drawing says is wrong, it says of the whole scene.
absl::Status OfScene(const absl::Status& status) {
  return base::WithDetails(status, {.reason = "SCENE_NOT_DRAWN", .field = "scene"});
}

// One picture on its way: read (executor), drawn (render loop), encoded (executor). Finish is
// called by exactly one of these steps; gRPC deletes the reactor through OnDone, after which no
// step runs.
class PictureReactor : public grpc::ServerUnaryReactor {
 public:
  PictureReactor(Engine& engine, const v1::RenderImageRequest& request,
                 v1::RenderImageResponse& response)
      : engine_(engine), request_(request), response_(response) {}

  void Begin() {
    engine_.executor.Submit([this](const absl::Status& status) {
      const absl::Status submitted = status.ok() ? ReadAndSubmit() : status;
      if (!submitted.ok()) Finish(ToGrpcStatus(submitted));
    });
  }

  void OnCancel() override {
    *cancelled_ = true;
    engine_.wake.Notify();
  }

  void OnDone() override { delete this; }

 private:
  absl::Status ReadAndSubmit() {
    if (*cancelled_) return absl::CancelledError("the picture was no longer wanted");
    v1::Scene& scene = *response_.mutable_scene();
    base::Stopwatch stopwatch;
    THUNDERHEAD_ASSIGN_OR_RETURN(
        auto fields, ReadFields(engine_.store, scene.storm_id(),
                                static_cast<int>(scene.time_index()), "scene.storm_id"));
    ToMessage({scene::FrameStage::kRead, stopwatch.ElapsedMs()}, *response_.add_stages());
    FrameCondensate(scene, *fields);
    const scene::Scene drawn = ToScene(scene);
    stopwatch.Restart();
    THUNDERHEAD_RETURN_IF_ERROR(OfScene(engine_.loop.Prepare(drawn, fields)));
    if (std::holds_alternative<scene::Metaballs>(drawn.rendering.technique)) {
      ToMessage({scene::FrameStage::kFit, stopwatch.ElapsedMs()}, *response_.add_stages());
    }
    engine_.loop.RenderImage(
        {drawn, std::move(fields), cancelled_,
         [this](absl::StatusOr<session::DisplayFrame> picture) { Drawn(std::move(picture)); }});
    return absl::OkStatus();
  }

  void Drawn(absl::StatusOr<session::DisplayFrame> picture) {
    if (!picture.ok()) return Finish(ToGrpcStatus(OfScene(picture.status())));
    const auto drawn = std::make_shared<session::DisplayFrame>(*std::move(picture));
    engine_.executor.Submit([this, drawn](const absl::Status& status) {
      Finish(ToGrpcStatus(status.ok() ? Encode(*drawn, request_, response_) : status));
    });
  }

  Engine& engine_;
  const v1::RenderImageRequest& request_;
  v1::RenderImageResponse& response_;
  const std::shared_ptr<std::atomic<bool>> cancelled_ = std::make_shared<std::atomic<bool>>(false);
};

}  // namespace

grpc::ServerUnaryReactor* RenderImage(Engine& engine, grpc::CallbackServerContext* context,
                                      const v1::RenderImageRequest* request,
                                      v1::RenderImageResponse* response) {
  absl::Status status = CheckLimits(*request);
  *response->mutable_scene() = request->scene();
  if (status.ok())
    status = PrepareScene(engine.store, engine.loop.Techniques(), *response->mutable_scene());
  if (!status.ok()) return Finished(context, status);
  if (response->scene().rendering().has_reference()) {
    return Finished(context,
                    base::InvalidField("scene.rendering.reference",
                                       "is given, which only sessions show; for a file use "
                                       "thunderhead render --renderer reference",
                                       "TECHNIQUE_FOR_SESSIONS_ONLY"));
  }
  auto* reactor = new PictureReactor(engine, *request, *response);
  reactor->Begin();
  return reactor;
}

}  // namespace thunderhead::service
