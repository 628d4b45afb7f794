// Frame rates of one storm in all named settings: each technique in the papers' modes, and the
// presets. Measures whole frames, from a changed scene to a JPEG. Uses the current GL context.
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
  int width_px = 300;  // the papers' size and slices
  int height_px = 300;
  int slices = scene::HalfAngle{}.slices;
  scene::Transport transport = scene::Transport::kConsistent;  // for the papers' translucent modes
  int runs = 5;                                                // results are their medians
  double seconds_a_run = 0.4;
  std::string only_mode{};  // if not empty, only rows of this mode are measured
};

struct StageMedian {
  scene::FrameStage stage = scene::FrameStage::kRead;
  double milliseconds = 0.0;
};

struct FrameRateRow {
  std::string_view technique;
  std::string_view mode;    // the papers' mode or preset; "default": the setting of a new scene
  double camera_fps = 0.0;  // the camera moves every frame
  double sun_fps = 0.0;     // the sun moves every frame
  // The stages that a camera move reruns, and the light stage, which only a sun move reruns.
  std::vector<StageMedian> stages;
  // FLIP of such a frame against one with one ray per pixel and fully solved light, after a camera
  // move and after a sun move. None if frames are drawn in full anyway.
  std::optional<double> camera_flip{};
  std::optional<double> sun_flip{};
};

absl::StatusOr<std::vector<FrameRateRow>> MeasureFrameRates(
    const std::shared_ptr<const volume::HydrometeorFields>& fields, const FrameRateOptions& options,
    const std::function<void(double share)>& progress);

std::string ToJson(const Machine& machine, const std::vector<FrameRateRow>& rows);
std::string ToTable(const Machine& machine, const std::vector<FrameRateRow>& rows);

// Returns the mass of all condensate, which is largest in a mature storm.
double Condensate_kg(const volume::HydrometeorFields& fields);

}  // namespace thunderhead::measure
