// What the render loop asks of the engine that draws: a scene and a storm's fields in, display
// pixels out. The GL engine implements it; service tests use a fake one. A FrameSource lives and
// works on one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "correction/light_progress.h"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "physics/hydrometeors.h"
#include "picture/linear_picture.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::session {

// How finely a frame is drawn: full quality is the scene's own slices at scale 1.
struct FrameQuality {
  double image_scale =
      1.0;  // of the eye buffer's width and height, (0, 1]; the frame keeps the scene's size
  double slice_share = 1.0;  // of the scene's slices, (0, 1]

  bool operator==(const FrameQuality&) const = default;
};

// One stage's wall time. Stages: "read", "extinction", "upload", "fit", "surface", "slices",
// "light", "view", "ground", "composite", "trace", "correction", "tone", "read_back", "encode".
struct StageCost {
  std::string stage;
  double milliseconds = 0.0;
};

// What a frame modelled.
struct Modelled {
  std::vector<physics::Hydrometeor> fields;
  int slices = 0;
  std::uint64_t device_bytes = 0;
  double occupied_share = 0.0;
  scene::Renderer renderer = scene::Renderer::kLightVolume;
  int balls = 0;                       // metaballs
  double fit_error = 0.0;              // of those, over the extinction's root mean square
  std::vector<std::string> not_shown;  // what the renderer cannot show
  int ellipsoids = 0;                  // of a cumulus
  std::int64_t traced_paths = 0;       // that corrected the light
};

// How far a picture by the reference has come.
struct Refinement {
  int samples_per_pixel = 0;  // that every pixel has
  // Root of the mean squared standard error over the mean radiance; none where samples are too few.
  std::optional<double> relative_error;

  bool operator==(const Refinement&) const = default;
};

// How accurate a picture is believed to be; errors are relative RMSE of linear radiance.
struct AccuracyReport {
  scene::Renderer renderer = scene::Renderer::kLightVolume;
  scene::Mode mode = scene::Mode::kPerFieldPhaseTranslucent;
  scene::Transport transport = scene::Transport::kConsistent;
  int slices = 0;                     // of this picture
  double image_scale = 1.0;           // of this picture
  std::optional<double> expected_ms;  // of a frame at full quality, on this machine
  double model_error = 0.0;           // by the table
  std::optional<double> discretisation_error;
  double estimated_error = 0.0;
  std::string unmet;  // why what the scene asks for is not reached; empty where it is

  bool operator==(const AccuracyReport&) const = default;
};

// A finished picture: 8-bit sRGB, three bytes a pixel, rows from top to bottom.
struct DisplayFrame {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> rgb;
  std::vector<StageCost> stages;
  Modelled modelled;
  std::optional<AccuracyReport> accuracy;
};

// A picture at full quality, and how much it differs from one with half the slices: no less than
// its own distance from endlessly many, where that falls with the slices at first order or faster.
struct CheckedFrame {
  DisplayFrame frame;
  double discretisation_error = 0.0;  // relative RMSE of linear radiance
};

// What the source draws on.
struct DeviceInfo {
  std::string device;       // "software" or "gpu 0"
  std::string gl_renderer;  // OpenGL's renderer string
  std::string gl_version;
};

// What drawing some scenes needs once and takes seconds: done beside the thread that draws, which
// would else keep every session waiting. Safe from any thread.
class Preparation {
 public:
  using Fields = std::shared_ptr<const volume::HydrometeorFields>;

  virtual ~Preparation() = default;

  // False if a scene never waits for anything, from whatever fields.
  virtual bool IsNeeded(const scene::Scene& scene) const = 0;

  // True if drawing `scene` from `fields` (of its storm and time) has nothing to wait for.
  virtual bool IsDone(const scene::Scene& scene, const Fields& fields) = 0;
  // Blocks until it has.
  virtual absl::Status Prepare(const scene::Scene& scene, const Fields& fields) = 0;
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  virtual const DeviceInfo& Device() const = 0;

  // Null if no scene needs any.
  virtual std::shared_ptr<Preparation> PreparationOfScenes() const { return nullptr; }

  // Draws `scene` from `fields` (of the scene's storm and time). Reruns only the stages that differ
  // from the frame drawn before.
  virtual absl::StatusOr<DisplayFrame> Draw(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      const FrameQuality& quality) = 0;

  // Draws at full quality and with half the slices; a scene of one slice cannot be checked.
  virtual absl::StatusOr<CheckedFrame> DrawChecked(
      const scene::Scene& scene,
      const std::shared_ptr<const volume::HydrometeorFields>& fields) = 0;

  // Traces some more paths for a scene with traced light, about a tenth of a second long, so that
  // the next Draw of it is better. RESOURCE_EXHAUSTED while too many other scenes are traced for.
  virtual absl::StatusOr<correction::LightProgress> TraceLight(
      const scene::Scene& scene,
      const std::shared_ptr<const volume::HydrometeorFields>& fields) = 0;

  // Tone maps what was computed elsewhere. What Draw keeps stays kept.
  virtual absl::StatusOr<DisplayFrame> Tone(const picture::LinearPicture& picture,
                                            const scene::Display& display) = 0;
};

// Makes the source on the thread that will use it.
using FrameSourceFactory = std::function<absl::StatusOr<std::unique_ptr<FrameSource>>()>;

}  // namespace thunderhead::session
