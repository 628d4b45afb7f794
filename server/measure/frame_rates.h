// Measures the frame rates of one storm in all named settings: each technique in the four modes of
// the papers' table (accuracy::kModes), the presets, and the default. The time of a frame is that
// from the change of the scene to the JPEG. The measurement uses the current GL context.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "measure/machine.h"
#include "scene/frame_stage.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::measure {

struct FrameRateOptions {
  int width_px = 300;  // Size and number of slices as in the papers.
  int height_px = 300;
  int slices = scene::HalfAngle{}.slices;
  // Transport for the papers' translucent modes.
  scene::Transport transport = scene::Transport::kConsistent;
  int runs = 5;  // number of runs, whose median is the result
  double seconds_a_run = 0.4;
  std::string only_mode{};  // if not empty, only rows of this mode are measured
};

struct StageMedian {
  scene::FrameStage stage = scene::FrameStage::kRead;
  double milliseconds = 0.0;
};

struct FrameRateRow {
  std::string_view technique;
  std::string_view mode;    // the papers' mode or a preset; "default" is the setting of a new scene
  double camera_fps = 0.0;  // frames per second if the camera moves before every frame
  double sun_fps = 0.0;     // frames per second if the sun moves before every frame
  // The stages that a camera move reruns, and the light stage, which only a sun move reruns.
  std::vector<StageMedian> stages;
  // FLIP difference (measure/image_error.h) between a frame as drawn during a move and one with one
  // ray a pixel and fully solved light. It is measured after a camera move and after a sun move. No
  // value if frames during a move are drawn in full anyway.
  std::optional<double> camera_flip{};
  std::optional<double> sun_flip{};
};

absl::StatusOr<std::vector<FrameRateRow>> MeasureFrameRates(
    const std::shared_ptr<const volume::HydrometeorFields>& fields, const FrameRateOptions& options,
    const std::function<void(double share)>& progress);

std::string ToJson(const Machine& machine, const std::vector<FrameRateRow>& rows);
std::string ToTable(const Machine& machine, const std::vector<FrameRateRow>& rows);

// Returns the mass of all condensate. The time with the largest mass shows a mature storm, so it is
// the one to measure.
double Condensate_kg(const volume::HydrometeorFields& fields);

}  // namespace thunderhead::measure
