#include "service/engine/frame_messages.h"

#include <array>
#include <cstdint>
#include <utility>

#include "base/utf8.h"
#include "service/messages/camera_messages.h"
#include "service/messages/enum_tables.h"
#include "service/messages/scene_messages.h"
#include "service/messages/sun_messages.h"
#include "service/messages/technique_messages.h"

namespace thunderhead::service {
namespace {

constexpr std::array kStages = {
    std::pair{v1::STAGE_READ, scene::FrameStage::kRead},
    std::pair{v1::STAGE_EXTINCTION, scene::FrameStage::kExtinction},
    std::pair{v1::STAGE_UPLOAD, scene::FrameStage::kUpload},
    std::pair{v1::STAGE_FIT, scene::FrameStage::kFit},
    std::pair{v1::STAGE_SURFACE, scene::FrameStage::kSurface},
    std::pair{v1::STAGE_SLICES, scene::FrameStage::kSlices},
    std::pair{v1::STAGE_LIGHT, scene::FrameStage::kLight},
    std::pair{v1::STAGE_VIEW, scene::FrameStage::kView},
    std::pair{v1::STAGE_GROUND, scene::FrameStage::kGround},
    std::pair{v1::STAGE_AIR, scene::FrameStage::kAir},
    std::pair{v1::STAGE_COMPOSITE, scene::FrameStage::kComposite},
    std::pair{v1::STAGE_TRACE, scene::FrameStage::kTrace},
    std::pair{v1::STAGE_CORRECTION, scene::FrameStage::kCorrection},
    std::pair{v1::STAGE_TONE, scene::FrameStage::kTone},
    std::pair{v1::STAGE_READ_BACK, scene::FrameStage::kReadBack},
    std::pair{v1::STAGE_ENCODE, scene::FrameStage::kEncode},
};
constexpr std::array kNotShownCodes = {
    std::pair{v1::NotShown::CODE_FINE_STRUCTURE, scene::NotShown::Code::kFineStructure},
    std::pair{v1::NotShown::CODE_DETAIL, scene::NotShown::Code::kDetail},
    std::pair{v1::NotShown::CODE_FIELD_OPTICS, scene::NotShown::Code::kFieldOptics},
    std::pair{v1::NotShown::CODE_TRACED_LIGHT, scene::NotShown::Code::kTracedLight},
    std::pair{v1::NotShown::CODE_LIGHTS, scene::NotShown::Code::kLights},
    std::pair{v1::NotShown::CODE_FIELDS, scene::NotShown::Code::kFields},
    std::pair{v1::NotShown::CODE_STORM, scene::NotShown::Code::kStorm},
    std::pair{v1::NotShown::CODE_BORDERS, scene::NotShown::Code::kBorders},
    std::pair{v1::NotShown::CODE_OTHER, scene::NotShown::Code::kOther},
};
constexpr std::array kUnmetCodes = {
    std::pair{v1::Unmet::CODE_ERROR_OUT_OF_REACH, accuracy::Unmet::Code::kErrorOutOfReach},
    std::pair{v1::Unmet::CODE_TIME_OUT_OF_REACH, accuracy::Unmet::Code::kTimeOutOfReach},
};
constexpr std::array kProblemCodes = {
    std::pair{v1::Problem::CODE_INTERNAL, delivery::Problem::Code::kInternal},
    std::pair{v1::Problem::CODE_STORM_GONE, delivery::Problem::Code::kStormGone},
    std::pair{v1::Problem::CODE_STORM_UNREADABLE, delivery::Problem::Code::kStormUnreadable},
    std::pair{v1::Problem::CODE_SCENE, delivery::Problem::Code::kScene},
    std::pair{v1::Problem::CODE_BUSY, delivery::Problem::Code::kBusy},
};

}  // namespace

void ToMessage(const delivery::Modelled& modelled, v1::Modelled& message) {
  const renderers::Content& content = modelled.content;
  for (physics::Hydrometeor field : content.fields) message.add_fields(ToMessage(field));
  message.set_technique(modelled.technique);
  message.set_slices(static_cast<std::uint32_t>(modelled.slices));
  message.set_device_bytes(modelled.device_bytes);
  message.set_occupied_share(static_cast<float>(content.occupied_share));
  message.set_balls(static_cast<std::uint32_t>(content.balls));
  message.set_fit_error(static_cast<float>(content.fit_error));
  message.set_ellipsoids(static_cast<std::uint32_t>(content.ellipsoids));
  message.set_traced_paths(static_cast<std::uint64_t>(modelled.traced_paths));
  message.set_exposure_ev(static_cast<float>(modelled.exposure_ev));
  ToMessage(content.ground, *message.mutable_ground());
  for (const scene::NotShown& not_shown : content.not_shown) {
    v1::NotShown& entry = *message.add_not_shown();
    entry.set_code(MessageOf(kNotShownCodes, not_shown.code));
    entry.set_message(base::Printable(not_shown.message));
  }
}

void ToMessage(const scene::StageTime& time, v1::StageCost& message) {
  message.set_stage(MessageOf(kStages, time.stage));
  message.set_milliseconds(static_cast<float>(time.milliseconds));
}

void ToMessage(const delivery::Refinement& refinement, v1::Refinement& message) {
  message.set_samples_per_pixel(static_cast<std::uint32_t>(refinement.samples_per_pixel));
  if (refinement.relative_error.has_value()) {
    message.set_relative_error(static_cast<float>(*refinement.relative_error));
  }
}

void ToMessage(const accuracy::AccuracyReport& report, v1::AccuracyReport& message) {
  ToMessage(report.technique, *message.mutable_rendering());
  message.set_slices(static_cast<std::uint32_t>(report.slices));
  message.set_image_scale(static_cast<float>(report.image_scale));
  if (report.expected_ms.has_value()) {
    message.set_expected_milliseconds(static_cast<float>(*report.expected_ms));
  }
  message.set_model_error(static_cast<float>(report.model_error));
  if (report.discretisation_error.has_value()) {
    message.set_discretisation_error(static_cast<float>(*report.discretisation_error));
  }
  message.set_estimated_error(static_cast<float>(report.estimated_error));
  if (report.measured.has_value()) {
    const accuracy::MeasuredError& measured = *report.measured;
    message.set_measured(true);
    message.set_error_low(static_cast<float>(measured.relative_rmse.low));
    message.set_error_high(static_cast<float>(measured.relative_rmse.high));
    message.set_bias(static_cast<float>(measured.relative_bias.value));
    message.set_bias_low(static_cast<float>(measured.relative_bias.low));
    message.set_bias_high(static_cast<float>(measured.relative_bias.high));
  }
  if (report.unmet.has_value()) {
    message.mutable_unmet()->set_code(MessageOf(kUnmetCodes, report.unmet->code));
    message.mutable_unmet()->set_message(base::Printable(report.unmet->message));
  }
}

void ToMessage(const delivery::EncodedFrame& frame, v1::Frame& message) {
  message.set_sequence(frame.sequence);
  message.set_scene_revision(frame.scene_revision);
  if (!frame.jpeg.empty()) message.set_jpeg(frame.jpeg);
  if (!frame.vp9.empty()) message.set_vp9(frame.vp9);
  if (!frame.avif.empty()) message.set_avif(frame.avif);
  message.set_key_frame(frame.key_frame);
  message.set_width_px(static_cast<std::uint32_t>(frame.width_px));
  message.set_height_px(static_cast<std::uint32_t>(frame.height_px));
  ToMessage(frame.camera, *message.mutable_camera());
  ToMessage(frame.view, *message.mutable_view());
  ToMessage(frame.sun, *message.mutable_sun());
  for (const scene::StageTime& time : frame.stages) ToMessage(time, *message.add_stages());
  ToMessage(frame.modelled, *message.mutable_modelled());
  message.set_refined(frame.refined);
  message.set_tier(static_cast<std::uint32_t>(frame.tier));
  if (frame.refinement.has_value()) {
    ToMessage(*frame.refinement, *message.mutable_refinement());
  }
  if (frame.accuracy.has_value()) ToMessage(*frame.accuracy, *message.mutable_accuracy());
}

void ToMessage(const delivery::Problem& problem, v1::Problem& message) {
  message.set_scene_revision(problem.scene_revision);
  message.set_message(base::Printable(problem.message));
  message.set_code(MessageOf(kProblemCodes, problem.code));
}

}  // namespace thunderhead::service
