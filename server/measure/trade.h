// Speed against accuracy: the cost of each setting of the renderers for one scene, and the error of
// its picture against the reference. Owns GL objects: use it on the context's thread.
#pragma once

#include <limits>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "accuracy/error_meter.h"
#include "accuracy/light_corrector.h"
#include "accuracy/setting.h"
#include "frame/image_codec.h"
#include "frame/tone_map.h"
#include "gl/program.h"
#include "measure/against_truth.h"
#include "picture/linear_picture.h"
#include "renderers/scene_renderer.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::measure {

using accuracy::Setting;

inline constexpr double kUnmeasured = std::numeric_limits<double>::quiet_NaN();

struct TradeRow {
  Setting setting;
  double milliseconds = 0.0;         // median for a frame with a moved camera, JPEG included
  double milliseconds_spread = 0.0;  // difference between its quartiles
  std::size_t bytes = 0;             // size of the JPEG
  double relative_rmse = 0.0;        // of linear radiance, without the reference's own noise
  double relative_bias = 0.0;
  double flip = 0.0;  // of the decoded JPEG
  // The relative RMSE as a server, which has no reference picture, estimates it. NaN if it was not
  // estimated.
  accuracy::Estimated estimated_error{kUnmeasured, kUnmeasured, kUnmeasured};
  bool pareto = false;  // no other setting is both faster and more accurate
};

// Returns all renderers, modes, transports and numbers of slices at full size. For metaballs it has
// the default mode and several numbers of balls. The default renderer and mode also have smaller
// pictures, 4 rays per pixel, finer and coarser light volumes, single precision and other JPEG
// qualities. They also have light traced with each of `million_paths`.
std::vector<Setting> DefaultSweep(const std::vector<double>& million_paths);

// Returns settings of the light volume only, as viewers see it. Each field has its own phase
// function, with consistent transport and with diffusion, and with light traced with each of
// `million_paths`.
std::vector<Setting> TransportSweep(const std::vector<double>& million_paths);

// Marks the Pareto front of milliseconds and relative RMSE.
void MarkPareto(std::vector<TradeRow>* rows);

// Returns the scene that the reference traces: each field has its own phase function and true
// colours.
scene::Scene TrueScene(scene::Scene scene);

class Trade {
 public:
  // `scene` gives the settings that are not swept. The reference `truth` must have its size. Each
  // picture's error is also estimated for `error_seconds`; 0: not estimated.
  Trade(scene::Scene scene, std::shared_ptr<const volume::HydrometeorFields> fields,
        AgainstTruth truth, double error_seconds);

  // Measures a setting. CANCELLED if `stop` was requested while paths were traced. Traced paths are
  // kept for the next setting, so settings that differ only in their number are best measured in
  // ascending order.
  absl::StatusOr<TradeRow> Measure(const Setting& setting, const std::stop_token& stop);

 private:
  absl::Status Estimate(const scene::Scene& scene, const picture::LinearPicture& image,
                        const std::stop_token& stop, accuracy::Estimated* estimate);
  absl::StatusOr<frame::RgbImage> Display(const gl::Texture2D& linear);
  // Returns the correction by that many paths; null for 0 paths.
  absl::StatusOr<std::shared_ptr<const renderers::LightCorrection>> CorrectionOf(
      const scene::Scene& scene, double million_paths, const std::stop_token& stop);

  scene::Scene scene_;
  std::shared_ptr<const volume::HydrometeorFields> fields_;
  AgainstTruth truth_;
  double error_seconds_;
  frame::RgbImage truth_display_;
  renderers::SceneRenderer renderer_;
  // Programs of the correctors and error meters.
  const std::shared_ptr<gl::ProgramCache> programs_ = std::make_shared<gl::ProgramCache>();
  std::unique_ptr<accuracy::LightCorrector> corrector_;
  double corrected_by_ = 0.0;  // million paths of the last request
  frame::ToneMapper tone_mapper_;
};

}  // namespace thunderhead::measure
