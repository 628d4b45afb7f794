// The trade of speed against accuracy. For each setting of the renderers and one scene, the class
// measures the time and the error of the picture against the path-traced reference. It owns GL
// objects, so use it on the context's thread.
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
#include "measure/reference_comparison.h"
#include "picture/linear_picture.h"
#include "renderers/scene_renderer.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::measure {

using accuracy::Setting;

inline constexpr double kUnmeasured = std::numeric_limits<double>::quiet_NaN();

struct TradeRow {
  Setting setting;
  double milliseconds = 0.0;         // median time from a moved camera to the frame's JPEG
  double milliseconds_spread = 0.0;  // difference between the quartiles of that time
  std::size_t bytes = 0;             // size of the JPEG
  // Error of linear radiance, without the part that the reference's noise causes.
  double relative_rmse = 0.0;
  double relative_bias = 0.0;
  double flip = 0.0;  // FLIP difference (image_error.h) of the decoded JPEG
  // The estimate of the relative RMSE that a server without a reference picture makes. NaN if it
  // was not estimated.
  accuracy::Estimated estimated_error{kUnmeasured, kUnmeasured, kUnmeasured};
  bool pareto = false;  // see MarkPareto
};

// Returns the settings to measure. They contain the light volume and half-angle slicing at full
// size, in all modes without detail, with all their transports and several numbers of slices.
// Metaballs have only the default mode, with several numbers of balls. The default technique and
// mode also appear with smaller pictures, with 4 rays a pixel, with finer and coarser light
// volumes, with single precision and with other JPEG qualities. They also appear with light
// corrected by path tracing, once for each number in `million_paths`.
std::vector<Setting> DefaultSweep(const std::vector<double>& million_paths);

// Returns settings of the light volume only, at full size and with its default number of slices.
// Each field has its own phase function. The transports are consistent transport and diffusion.
// Diffusion also appears with light corrected by path tracing, once for each number in
// `million_paths`.
std::vector<Setting> TransportSweep(const std::vector<double>& million_paths);

// Marks the Pareto front of milliseconds and relative RMSE. A row is on the front if no other row
// is better in one of the two and at least as good in the other.
void MarkPareto(std::vector<TradeRow>* rows);

// Returns the scene that the reference traces. Each field has its own phase function, and there are
// no false colours.
scene::Scene ReferenceScene(scene::Scene scene);

class Trade {
 public:
  // `scene` gives the settings that are not varied. The measured pictures have the size of the
  // reference picture of `comparison`. A server's error estimate is also made for each picture, for
  // `error_seconds` seconds. With 0 there is no estimate.
  Trade(scene::Scene scene, std::shared_ptr<const volume::HydrometeorFields> fields,
        ReferenceComparison comparison, double error_seconds);

  // Measures a setting. Returns CANCELLED if `stop` was requested during path tracing. Traced paths
  // are kept for the next setting. Settings that differ only in the number of paths are therefore
  // best measured in ascending order.
  absl::StatusOr<TradeRow> Measure(const Setting& setting, const std::stop_token& stop);

 private:
  absl::Status Estimate(const scene::Scene& scene, const picture::LinearPicture& image,
                        const std::stop_token& stop, accuracy::Estimated* estimate);
  absl::StatusOr<frame::RgbImage> Display(const gl::Texture2D& linear);
  // Returns the correction fitted to that many million paths, or null for 0 paths.
  absl::StatusOr<std::shared_ptr<const renderers::LightCorrection>> CorrectionOf(
      const scene::Scene& scene, double million_paths, const std::stop_token& stop);

  scene::Scene scene_;
  std::shared_ptr<const volume::HydrometeorFields> fields_;
  ReferenceComparison comparison_;
  double error_seconds_;
  frame::RgbImage reference_display_;
  renderers::SceneRenderer renderer_;
  // Shader programs of the correctors and the error estimates.
  const std::shared_ptr<gl::ProgramCache> programs_ = std::make_shared<gl::ProgramCache>();
  std::unique_ptr<accuracy::LightCorrector> corrector_;
  double corrected_by_ = 0.0;  // number of paths (in millions) of the last CorrectionOf
  frame::ToneMapper tone_mapper_;
};

}  // namespace thunderhead::measure
