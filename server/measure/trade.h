// Speed against accuracy: what each setting of the renderers costs for one scene, and how far its
// picture is from the reference. Owns GL objects: use it on the context's thread.
#pragma once

#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "accuracy/light_corrector.h"
#include "accuracy/setting.h"
#include "frame/tone_map.h"
#include "measure/image_error.h"
#include "picture/linear_picture.h"
#include "renderers/scene_renderer.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::measure {

using accuracy::Setting;

struct TradeRow {
  Setting setting;
  double milliseconds = 0.0;         // a frame with a moved camera, JPEG included: median
  double milliseconds_spread = 0.0;  // between its quartiles
  std::size_t bytes = 0;             // of the JPEG
  double relative_rmse = 0.0;        // of linear radiance, without the truth's own noise
  double relative_bias = 0.0;
  double flip = 0.0;    // of the decoded JPEG
  bool pareto = false;  // no other setting is both faster and closer
};

// Every renderer, mode, transport and number of slices at full size (of metaballs the default mode
// and some numbers of them), then smaller pictures and 4 rays a pixel, finer and coarser light
// volumes, single precision, other JPEG qualities and traced light, with so many `million_paths`,
// of the default renderer and mode.
std::vector<Setting> DefaultSweep(const std::vector<double>& million_paths);

// Marks the rows that no other beats in both milliseconds and relative RMSE.
void MarkPareto(std::vector<TradeRow>* rows);

// The scene whose picture by the reference is the truth: every field's own phase function, true
// colours.
scene::Scene TrueScene(scene::Scene scene);

class Trade {
 public:
  // `scene` gives what is not swept; the truth has its size.
  Trade(scene::Scene scene, std::shared_ptr<const volume::HydrometeorFields> fields,
        picture::LinearPicture truth);

  // CANCELLED if `stop` asked to stop while paths were traced. Those are kept: settings that differ
  // in their number alone are best measured from few to many.
  absl::StatusOr<TradeRow> Measure(const Setting& setting, const std::stop_token& stop);

  // What relative RMSE the truth's own noise amounts to.
  double TruthNoise() const { return truth_noise_; }

 private:
  absl::StatusOr<DisplayImage> Display(const gl::Texture2D& linear);
  // What so many paths correct; null for none.
  absl::StatusOr<std::shared_ptr<const renderers::LightCorrection>> CorrectionOf(
      const scene::Scene& scene, double million_paths, const std::stop_token& stop);

  scene::Scene scene_;
  std::shared_ptr<const volume::HydrometeorFields> fields_;
  picture::LinearPicture truth_;
  DisplayImage truth_display_;
  double truth_noise_ = 0.0;
  renderers::SceneRenderer renderer_;
  std::unique_ptr<accuracy::LightCorrector> corrector_;
  double corrected_by_ = 0.0;  // million paths that it was asked for last
  frame::ToneMapper tone_mapper_;
};

}  // namespace thunderhead::measure
