// The interface between the render loop and the drawing engine. The input is a scene and a storm's
// fields, the output display pixels. The GL engine implements the interface; service tests use a
// fake. A FrameSource is created, used and destroyed on one thread. Each drawing thread has its own
// source.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "accuracy/accuracy_report.h"
#include "accuracy/error_meters.h"
#include "accuracy/frame_quality.h"
#include "accuracy/light_progress.h"
#include "base/device_turn.h"
#include "base/memory_budget.h"
#include "delivery/frame_content.h"
#include "frame/fine_image.h"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "physics/hydrometeors.h"
#include "picture/linear_picture.h"
#include "renderers/content.h"
#include "renderers/preparation.h"
#include "scene/frame_stage.h"
#include "scene/scene.h"
#include "scene/technique_info.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::drawing {

using accuracy::AccuracyReport;
using accuracy::FrameQuality;
using scene::StageTime;

// A finished picture in 8-bit sRGB: three bytes per pixel, rows from top to bottom.
struct DisplayFrame {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> rgb;
  std::vector<StageTime> stages;
  delivery::Modelled modelled;
  std::optional<AccuracyReport> accuracy;
  std::shared_ptr<const base::MemoryReservation> memory;  // reservation of the pixels' memory
  std::optional<picture::LinearPicture> linear;  // before the tone map; set if it was requested
};

// A picture at full quality, and its difference from the same picture drawn with half the slices.
struct CheckedFrame {
  DisplayFrame frame;
  double discretisation_error = 0.0;  // accuracy::DiscretisationError
};

// The device that the source draws on.
struct DeviceInfo {
  std::string device;       // "software" or "gpu 0"
  std::string gl_renderer;  // OpenGL's renderer string
  std::string gl_version;
};

using renderers::Preparation;

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  virtual const DeviceInfo& Device() const = 0;

  // Returns the techniques in the order in which to offer them.
  virtual std::vector<scene::TechniqueInfo> Techniques() const = 0;

  // Returns the object that prepares scenes before they are drawn, or null if no scene needs
  // preparation.
  virtual std::shared_ptr<Preparation> PreparationOfScenes() const { return nullptr; }

  // Draws `scene` from `fields`, which must belong to the scene's storm and time. Reruns only the
  // stages whose inputs differ from the previous frame's.
  virtual absl::StatusOr<DisplayFrame> Draw(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      const FrameQuality& quality) = 0;

  // Draws the scene at full quality and with half the slices. The scene must have more than one
  // slice.
  virtual absl::StatusOr<CheckedFrame> DrawChecked(
      const scene::Scene& scene,
      const std::shared_ptr<const volume::HydrometeorFields>& fields) = 0;

  // Traces paths for about a tenth of a second, for a scene with path-traced correction. The paths
  // improve the light of that scene in all sources of the same factory: at intervals, and once
  // `wanted_paths` are traced. RESOURCE_EXHAUSTED while light is traced for too many other scenes.
  // If `claim` is not null, it receives a claim that keeps the light traced for the scene from
  // being evicted.
  virtual absl::StatusOr<accuracy::LightProgress> TraceLight(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      std::int64_t wanted_paths, accuracy::LightClaim* claim) = 0;

  // Measures the error of the scene's full-quality picture with the light traced so far, for some
  // tenths of a second. Each call traces paths through the picture, or draws the picture again if
  // its light has become much better. RESOURCE_EXHAUSTED while the errors of too many other scenes
  // are measured.
  virtual absl::StatusOr<accuracy::ErrorProgress> MeasureError(
      const scene::Scene& /*scene*/,
      const std::shared_ptr<const volume::HydrometeorFields>& /*fields*/) {
    return accuracy::ErrorProgress{.ended = true};
  }

  // Applies the tone map to a picture of `scene` that was computed elsewhere. Does not change the
  // stages that Draw reuses.
  virtual absl::StatusOr<DisplayFrame> Tone(const picture::LinearPicture& picture,
                                            const scene::Scene& scene) = 0;

  // Returns the picture that the last call of Draw, DrawChecked or Tone produced, with more than 8
  // bits per channel. Returns an error if it is not available.
  virtual absl::StatusOr<frame::FineImage> Fine() {
    return absl::UnimplementedError("this frame source has pictures of 8 bits only");
  }

  // Returns the picture that the last call of Draw, DrawChecked or Tone produced, as linear
  // radiance with the storm's opacity.
  virtual absl::StatusOr<picture::LinearPicture> Linear() {
    return absl::UnimplementedError("this frame source has tone-mapped pictures only");
  }

  // Frees cached memory that was not used for drawing during the last `unused_s` seconds.
  virtual void FreeUnused(double /*unused_s*/) {}
};

// Creates a source on the thread that will use it. The source takes `turn` for each piece that it
// draws; `turn` must outlive the source. If `turn` is null, the source draws each picture in one
// piece, and its caller must hold the device's turn.
using FrameSourceFactory =
    std::function<absl::StatusOr<std::unique_ptr<FrameSource>>(base::DeviceTurn* turn)>;

}  // namespace thunderhead::drawing
