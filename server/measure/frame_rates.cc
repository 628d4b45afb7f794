#include "measure/frame_rates.h"

#include <algorithm>
#include <map>
#include <variant>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "accuracy/moving_picture.h"
#include "accuracy/named_settings.h"
#include "accuracy/presets.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "frame/image_codec.h"
#include "frame/tone_map.h"
#include "measure/image_error.h"
#include "renderers/scene_renderer.h"
#include "scene/view.h"
#include "volume/visible_box.h"

namespace thunderhead::measure {
namespace {

// Frames that are not measured, because the first frame compiles shaders.
constexpr int kWarmFrames = 2;
constexpr int kMinFrames = 3;  // minimum number of frames in a run
constexpr double kStep_deg = 1.0;

using scene::FrameStage;
using Samples = std::map<FrameStage, std::vector<double>>;

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Draws a scene repeatedly while the camera or the sun moves.
class Frames {
 public:
  Frames(scene::Scene scene, std::shared_ptr<const volume::HydrometeorFields> fields)
      : scene_(std::move(scene)), fields_(std::move(fields)) {}

  void MoveCamera() { std::get<scene::OrbitCamera>(scene_.camera).azimuth_deg += kStep_deg; }
  void MoveSun() { scene_.sun.azimuth_deg += kStep_deg; }

  // Draws and encodes a frame. Appends the milliseconds of each stage to `stages`.
  absl::Status Draw(Samples* stages) {
    renderers::StageTimes times;
    THUNDERHEAD_ASSIGN_OR_RETURN(const frame::ToneMapped mapped, DrawAsMoving(&times));
    const base::Stopwatch stopwatch;
    THUNDERHEAD_RETURN_IF_ERROR(frame::EncodeJpeg(scene_.output.width_px, scene_.output.height_px,
                                                  mapped.rgb, scene_.output.jpeg_quality)
                                    .status());
    for (const scene::StageTime& stage : times) {
      (*stages)[stage.stage].push_back(stage.milliseconds);
    }
    (*stages)[FrameStage::kTone].push_back(mapped.tone_ms);
    (*stages)[FrameStage::kReadBack].push_back(mapped.read_back_ms);
    (*stages)[FrameStage::kEncode].push_back(stopwatch.ElapsedMs());
    return absl::OkStatus();
  }

  // Returns the frames per second, measured over at least `seconds`. `move` changes the scene
  // before each frame.
  absl::StatusOr<double> Rate(void (Frames::*move)(), double seconds, Samples* stages) {
    const base::Stopwatch stopwatch;
    int frames = 0;
    while (frames < kMinFrames || stopwatch.ElapsedMs() < 1e3 * seconds) {
      (this->*move)();
      THUNDERHEAD_RETURN_IF_ERROR(Draw(stages));
      ++frames;
    }
    return 1e3 * frames / stopwatch.ElapsedMs();
  }

  // Returns the FLIP difference between a frame drawn during a move and the following frame at
  // rest. Both have the exposure of the first.
  absl::StatusOr<std::optional<double>> MovingFlip() {
    renderers::StageTimes times;
    THUNDERHEAD_ASSIGN_OR_RETURN(const frame::ToneMapped moving, DrawAsMoving(&times));
    if (!drawn_sparse_) return std::nullopt;
    THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame linear,
                                 renderer_.Draw(scene_, fields_, {}));
    scene::Scene exposed = scene_;
    exposed.display.exposure_ev = moving.exposure_ev;
    THUNDERHEAD_ASSIGN_OR_RETURN(const frame::ToneMapped plain,
                                 tone_mapper_.Map(*linear.radiance, exposed));
    const scene::Output& output = scene_.output;
    return Flip({output.width_px, output.height_px, moving.rgb},
                {output.width_px, output.height_px, plain.rgb});
  }

 private:
  // Draws a frame as sessions do while the camera or the sun moves. Appends the times of its
  // stages.
  absl::StatusOr<frame::ToneMapped> DrawAsMoving(renderers::StageTimes* times) {
    const accuracy::FrameQuality quality{.sparse = accuracy::MovesSparsely(scene_)};
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const renderers::LinearFrame linear,
        renderer_.Draw(scene_, fields_, accuracy::MovingQuality(scene_, quality)));
    *times = linear.stages;
    drawn_sparse_ = linear.coarse;
    if (!linear.coarse) return tone_mapper_.Map(*linear.radiance, scene_);
    THUNDERHEAD_ASSIGN_OR_RETURN(
        accuracy::CompletedPicture whole,
        accuracy::CompleteMoving(
            linear, scene_, quality, tone_mapper_,
            [this](const std::vector<glm::vec2>& places) { return renderer_.DrawChosen(places); },
            times));
    return std::move(whole.mapped);
  }

  scene::Scene scene_;
  std::shared_ptr<const volume::HydrometeorFields> fields_;
  renderers::SceneRenderer renderer_;
  frame::ToneMapper tone_mapper_;
  bool drawn_sparse_ = false;
};

scene::Scene SceneOf(const volume::HydrometeorFields& fields, const FrameRateOptions& options) {
  scene::Scene scene;
  scene.output.width_px = options.width_px;
  scene.output.height_px = options.height_px;
  const volume::WorldBox box = volume::VisibleBox(fields);
  const double aspect_ratio = static_cast<double>(options.width_px) / options.height_px;
  scene.camera = scene::Framing(scene::OrbitCamera(), box.low_m, box.high_m, aspect_ratio);
  return scene;
}

absl::StatusOr<FrameRateRow> MeasureRow(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
    const FrameRateOptions& options, FrameRateRow row) {
  Frames frames(scene, fields);
  Samples warming;
  for (int i = 0; i < kWarmFrames; ++i) THUNDERHEAD_RETURN_IF_ERROR(frames.Draw(&warming));
  Samples camera_stages;
  Samples sun_stages;
  std::vector<double> camera_fps;
  std::vector<double> sun_fps;
  for (int run = 0; run < options.runs; ++run) {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const double camera,
        frames.Rate(&Frames::MoveCamera, options.seconds_a_run, &camera_stages));
    THUNDERHEAD_ASSIGN_OR_RETURN(const double sun,
                                 frames.Rate(&Frames::MoveSun, options.seconds_a_run, &sun_stages));
    camera_fps.push_back(camera);
    sun_fps.push_back(sun);
  }
  frames.MoveCamera();
  THUNDERHEAD_ASSIGN_OR_RETURN(row.camera_flip, frames.MovingFlip());
  // The light was just solved fully, so the first step of the sun would be more accurate than
  // usual. Some steps therefore precede the measurement.
  for (int i = 0; i < kWarmFrames; ++i) {
    frames.MoveSun();
    THUNDERHEAD_RETURN_IF_ERROR(frames.Draw(&warming));
  }
  frames.MoveSun();
  THUNDERHEAD_ASSIGN_OR_RETURN(row.sun_flip, frames.MovingFlip());
  row.camera_fps = Median(camera_fps);
  row.sun_fps = Median(sun_fps);
  if (sun_stages.contains(FrameStage::kLight)) {
    camera_stages[FrameStage::kLight] = sun_stages[FrameStage::kLight];
  }
  for (const auto& [stage, milliseconds] : camera_stages) {
    row.stages.push_back({stage, Median(milliseconds)});
  }
  return row;
}

struct Case {
  scene::Technique technique;
  std::string_view mode;
};

// Returns all settings to measure. The presets and the default are without path-traced correction
// here, because tracing waits until the view is at rest.
std::vector<Case> CasesOf(const FrameRateOptions& options) {
  std::vector<Case> cases;
  for (const accuracy::PlainTechnique& plain : accuracy::kPlainTechniques) {
    for (const accuracy::Mode& mode : accuracy::kModes) {
      scene::Technique technique = accuracy::InMode(plain.settings(), mode, options.transport);
      scene::SetSlices(&technique, options.slices);
      cases.push_back({technique, mode.name});
    }
  }
  for (const accuracy::Preset preset :
       {accuracy::Preset::kFast, accuracy::Preset::kBalanced, accuracy::Preset::kAccurate}) {
    cases.push_back({accuracy::TechniqueOf(preset), accuracy::NameOf(preset)});
  }
  cases.push_back({accuracy::TechniqueOf(accuracy::kDefaultPreset), "default"});
  return cases;
}

std::string FlipsJson(const FrameRateRow& row) {
  if (!row.camera_flip.has_value() || !row.sun_flip.has_value()) return "";
  return absl::StrFormat("\"camera_flip\": %.4f, \"sun_flip\": %.4f, ", *row.camera_flip,
                         *row.sun_flip);
}

std::string StagesJson(const FrameRateRow& row) {
  return absl::StrJoin(row.stages, ", ", [](std::string* text, const StageMedian& stage) {
    absl::StrAppendFormat(text, "\"%s\": %.4g", scene::NameOf(stage.stage), stage.milliseconds);
  });
}

}  // namespace

absl::StatusOr<std::vector<FrameRateRow>> MeasureFrameRates(
    const std::shared_ptr<const volume::HydrometeorFields>& fields, const FrameRateOptions& options,
    const std::function<void(double share)>& progress) {
  scene::Scene scene = SceneOf(*fields, options);
  const std::vector<Case> cases = CasesOf(options);
  std::vector<FrameRateRow> rows;
  for (const Case& measured : cases) {
    if (!options.only_mode.empty() && measured.mode != options.only_mode) continue;
    scene.rendering.technique = measured.technique;
    THUNDERHEAD_ASSIGN_OR_RETURN(
        FrameRateRow row,
        MeasureRow(scene, fields, options,
                   {scene::NameOf(measured.technique), measured.mode, 0.0, 0.0, {}}));
    rows.push_back(std::move(row));
    progress(static_cast<double>(rows.size()) / static_cast<double>(cases.size()));
  }
  return rows;
}

std::string ToJson(const Machine& machine, const std::vector<FrameRateRow>& rows) {
  const std::string lines =
      absl::StrJoin(rows, ",\n", [](std::string* text, const FrameRateRow& row) {
        absl::StrAppendFormat(text,
                              "    {\"renderer\": \"%s\", \"mode\": \"%s\", \"camera_fps\": %.4g, "
                              "\"sun_fps\": %.4g, %s\"stages_ms\": {%s}}",
                              row.technique, row.mode, row.camera_fps, row.sun_fps, FlipsJson(row),
                              StagesJson(row));
      });
  return absl::StrCat("{\n  \"machine\": ", ToJson(machine), ",\n  \"rows\": [\n", lines,
                      "\n  ]\n}\n");
}

std::string ToTable(const Machine& machine, const std::vector<FrameRateRow>& rows) {
  std::string text = absl::StrFormat(
      "%s, %d threads; %s\n\n%-13s %-35s %10s %10s  %s\n", machine.processor, machine.threads,
      machine.gl_renderer, "renderer", "mode", "camera/s", "sun/s", "milliseconds by stage");
  for (const FrameRateRow& row : rows) {
    absl::StrAppendFormat(
        &text, "%-13s %-35s %10.1f %10.1f  %s\n", row.technique, row.mode, row.camera_fps,
        row.sun_fps, absl::StrJoin(row.stages, ", ", [](std::string* out, const auto& stage) {
          absl::StrAppendFormat(out, "%s %.2f", scene::NameOf(stage.stage), stage.milliseconds);
        }));
  }
  return text;
}

double Condensate_kg(const volume::HydrometeorFields& fields) {
  const glm::dvec3& cell_m = fields.grid.spacing_m;
  const double columns = static_cast<double>(fields.grid.cells.x) * fields.grid.cells.y;
  double path_kg_per_m2 = 0.0;
  for (const volume::HydrometeorField& field : fields.fields) {
    path_kg_per_m2 += field.statistics.mean_water_path_kg_per_m2;
  }
  return path_kg_per_m2 * columns * cell_m.x * cell_m.y;
}

}  // namespace thunderhead::measure
