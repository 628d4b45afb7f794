#include "service/engine/requested_image.h"

#include <limits>
#include <utility>

#include "base/error_details.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "frame/image_codec.h"
#include "frame/png_text.h"
#include "picture/exr_file.h"
#include "scene/optical_depths.h"
#include "scene/view.h"
#include "service/engine/frame_messages.h"
#include "service/messages/camera_messages.h"
#include "service/messages/limits_check.h"
#include "service/messages/picture_texts.h"
#include "service/messages/prepare_scene.h"
#include "service/messages/scene_messages.h"

namespace thunderhead::service {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

// Encodes the picture as linear radiance and optical depths in OpenEXR. The estimated error is not
// known yet, so its attribute is NaN.
absl::StatusOr<std::string> EncodeLight(drawing::DisplayFrame& picture,
                                        const volume::HydrometeorFields& fields,
                                        const storm_store::StormInfo* storm,
                                        const v1::RenderImageResponse& response) {
  scene::AddOpticalDepths(ToScene(response.scene()), fields, &*picture.linear);
  picture::ExrAttributes attributes{.texts = {}, .numbers = {{kErrorText, kUnknown}}};
  if (storm != nullptr) attributes.texts = TextsOf(response, *storm);
  return picture::EncodeExr(*picture.linear, attributes);
}

// Encodes the picture and consumes its pixels.
absl::Status Encode(drawing::DisplayFrame& picture, const v1::RenderImageRequest& request,
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

void Describe(const drawing::DisplayFrame& picture, double encode_ms,
              v1::RenderImageResponse& response) {
  for (const scene::StageTime& time : picture.stages) ToMessage(time, *response.add_stages());
  ToMessage({scene::FrameStage::kEncode, encode_ms}, *response.add_stages());
  ToMessage(picture.modelled, *response.mutable_modelled());
  if (picture.accuracy.has_value()) ToMessage(*picture.accuracy, *response.mutable_accuracy());
}

// Adds the description to the picture's file. A PNG file gets all texts. An OpenEXR file gets only
// the estimated error, which was unknown when the file was encoded. `storm` is null if the storm no
// longer exists.
void AddTexts(const storm_store::StormInfo* storm, v1::RenderImageResponse& response) {
  if (response.format() == v1::IMAGE_FORMAT_EXR && response.has_accuracy()) {
    picture::SetExrNumber(kErrorText, response.accuracy().estimated_error(),
                          response.mutable_image());
  }
  if (response.format() != v1::IMAGE_FORMAT_PNG || storm == nullptr) return;
  response.set_image(frame::WithTexts(response.image(), TextsOf(response, *storm)));
}

// Errors of drawing do not concern a single field of the scene, so they name the whole scene.
absl::Status OfScene(const absl::Status& status) {
  return base::WithDetails(status, {.reason = "SCENE_NOT_DRAWN", .field = "scene"});
}

}  // namespace

void RequestedImage::Begin() {
  if (const absl::Status late = counted_.Check(); !late.ok()) return End(late);
  if (const absl::Status wrong = CompleteScene(); !wrong.ok()) return End(wrong);
  engine_.loop.RenderImage(
      {ToScene(response_.scene()), [this] { return Read(); },
       [this](drawing::DisplayFrame& picture) { return EncodeTimed(picture); }, cancelled_,
       [this](const absl::StatusOr<drawing::DisplayFrame>& picture) { Drawn(picture); },
       [this](const drawing::ImageProgress& progress) { listener_.Progressed(progress); },
       awaited_ == Awaited::kByNobody, request_.format() == v1::IMAGE_FORMAT_EXR,
       request_.error_seconds(), static_cast<double>(engine_.limits.max_render_time.count()),
       RenderedTooLong(engine_.limits.max_render_time), owner_});
}

void RequestedImage::Cancel() {
  *cancelled_ = true;
  engine_.wake.Notify();
}

absl::Status RequestedImage::CompleteScene() {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request_));
  v1::Scene& scene = *response_.mutable_scene();
  scene = request_.scene();
  THUNDERHEAD_RETURN_IF_ERROR(PrepareScene(engine_.store, engine_.loop.Techniques(), scene));
  THUNDERHEAD_RETURN_IF_ERROR(CheckSize(engine_.limits, scene));
  if (!scene.rendering().has_reference()) return absl::OkStatus();
  return base::InvalidField("scene.rendering.reference",
                            "is given, which only sessions can show; for a file use "
                            "thunderhead render --technique reference",
                            "TECHNIQUE_FOR_SESSIONS_ONLY");
}

absl::StatusOr<drawing::ImageInput> RequestedImage::Read() {
  v1::Scene& scene = *response_.mutable_scene();
  THUNDERHEAD_ASSIGN_OR_RETURN(
      auto fields, ReadFields(engine_.store, scene.storm_id(), static_cast<int>(scene.time_index()),
                              "scene.storm_id"));
  FrameCondensate(scene, *fields);
  const scene::Scene value = ToScene(scene);
  ToMessage(scene::ViewOf(value, *fields), *response_.mutable_view());
  if (request_.format() == v1::IMAGE_FORMAT_EXR) fields_ = fields;
  return drawing::ImageInput{std::move(fields), value.camera};
}

absl::Status RequestedImage::EncodeTimed(drawing::DisplayFrame& picture) {
  const base::Stopwatch stopwatch;
  response_.set_width_px(static_cast<std::uint32_t>(picture.width_px));
  response_.set_height_px(static_cast<std::uint32_t>(picture.height_px));
  if (request_.format() == v1::IMAGE_FORMAT_EXR) {
    const storm_store::StormInfoPtr storm = engine_.store.Find(response_.scene().storm_id());
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

void RequestedImage::Drawn(const absl::StatusOr<drawing::DisplayFrame>& picture) {
  if (!picture.ok()) return End(OfScene(picture.status()));
  memory_ = picture->memory;
  Describe(*picture, encode_ms_, response_);
  AddTexts(engine_.store.Find(response_.scene().storm_id()).get(), response_);
  End(absl::OkStatus());
}

void RequestedImage::End(const absl::Status& status) { listener_.Ended(status); }

}  // namespace thunderhead::service
