// The drawing times of frames on this machine, learnt from the frames that it draws. From the
// observed frames, the class predicts the time of a view's next frame and the time of any setting
// in a table. It uses no clock.
#pragma once

#include <array>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "accuracy/cost_model.h"
#include "accuracy/frame_quality.h"
#include "accuracy/offer_tables.h"
#include "accuracy/table_correction.h"
#include "scene/frame_stage.h"
#include "scene/scene.h"

namespace thunderhead::accuracy {

// A frame that was drawn. The settings of its scene are final (Offers::Decide).
struct MeasuredFrame {
  const scene::Scene& scene;
  FrameQuality quality;
  double total_ms = 0.0;
  const std::vector<scene::StageTime>& stages;
  bool traced = false;            // true if traced paths corrected the frame's light
  std::string_view context = {};  // name of the OpenGL context; each context compiles its own
                                  // shaders
};

class MachineCosts {
 public:
  // `tables` must outlive this object.
  explicit MachineCosts(const OfferTables& tables) : tables_(tables) {}

  // Records a frame of the view named `view`. The first frame of each technique, mode and transport
  // in each context is ignored, with and without path-traced correction, because its time includes
  // the compilation of shaders.
  void Observe(const std::string& view, const MeasuredFrame& frame);

  // Returns the predicted time of the next frame of `view` if `first_dirty` is the first stage to
  // rerun. The prediction uses the frames of that view, or all frames if the view has no frames
  // yet. The times differ between views, because views show different parts of their storms.
  double FrameMs(const std::string& view, const scene::Scene& scene, const FrameQuality& quality,
                 scene::Stage first_dirty) const;
  void Forget(const std::string& view);

  // Returns the predicted time of a frame with the setting of `row` in the size of `scene`, if only
  // the camera has moved.
  double SettingMs(const PricedSettings& table, const PricedSetting& row,
                   const scene::Scene& scene) const;
  // Returns true if a frame at full quality with that setting was observed.
  bool Knows(const Setting& setting) const { return correction_.Knows(setting); }

 private:
  // One cost model for each technique, because the costs of techniques are unrelated.
  using Models = std::array<CostModel, std::variant_size_v<scene::Technique>>;
  // The names of technique, mode and transport, the name of the context, and whether traced paths
  // correct the light.
  using Shaders = std::tuple<std::string, std::string, std::string_view, std::string_view, bool>;

  void CompareWithTable(const scene::Scene& scene, double view_ms);

  const OfferTables& tables_;
  std::set<Shaders> compiled_;
  Models machine_;
  std::map<std::string, Models> views_;  // models by view; each begins as a copy of machine_, which
                                         // learns from the frames of all views
  TableCorrection correction_;
};

}  // namespace thunderhead::accuracy
