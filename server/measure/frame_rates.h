// Frames a second of one storm by every renderer path in every mode: whole frames, from a changed
// scene to a JPEG. Uses the current GL context.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "measure/machine.h"
#include "measure/paths.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::measure {

struct FrameRateOptions {
  int width_px = 300;  // the papers' size and slices
  int height_px = 300;
  int slices = 128;
  scene::Transport transport = scene::Transport::kConsistent;
  int runs = 5;  // of which the medians are taken
  double seconds_a_run = 0.4;
};

struct StageMedian {
  std::string stage;
  double milliseconds = 0.0;
};

struct FrameRateRow {
  Named<scene::Renderer> renderer;
  Named<scene::Mode> mode;
  double camera_fps = 0.0;  // the camera moves every frame
  double sun_fps = 0.0;     // the sun moves every frame
  // What a camera move reruns, and "light", which only a sun move reruns.
  std::vector<StageMedian> stages;
};

absl::StatusOr<std::vector<FrameRateRow>> MeasureFrameRates(
    const std::shared_ptr<const volume::HydrometeorFields>& fields, const FrameRateOptions& options,
    const std::function<void(double share)>& progress);

std::string ToJson(const Machine& machine, const std::vector<FrameRateRow>& rows);
std::string ToTable(const Machine& machine, const std::vector<FrameRateRow>& rows);

// Kilograms of condensate: what tells a mature storm from one that begins or ends.
double Condensate_kg(const volume::HydrometeorFields& fields);

}  // namespace thunderhead::measure
