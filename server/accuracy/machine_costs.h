// The cost of frames on this machine, learnt from the frames that it draws. Each frame is reported
// once. From them follow the cost of a view's next frame and that of a setting of a table. Plain
// values, no clock.
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

// A drawn frame of a decided scene.
struct MeasuredFrame {
  const scene::Scene& scene;
  FrameQuality quality;
  double total_ms = 0.0;
  const std::vector<scene::StageTime>& stages;
  bool traced = false;            // traced paths corrected its light
  std::string_view context = {};  // OpenGL context; each context compiles its own shaders
};

class MachineCosts {
 public:
  // `tables` must outlive it.
  explicit MachineCosts(const OfferTables& tables) : tables_(tables) {}

  // Records a frame of `view`, which names the picture's owner. The first frame of a setting in
  // each context is ignored because its time includes shader compilation.
  void Observe(const std::string& view, const MeasuredFrame& frame);

  // Returns the predicted time of the next frame of `view` if `first_dirty` is the first stage to
  // rerun. It uses that view's frames, or all frames if the view has none yet. Views differ in how
  // much of their storm they look through.
  double FrameMs(const std::string& view, const scene::Scene& scene, const FrameQuality& quality,
                 scene::Stage first_dirty) const;
  void Forget(const std::string& view);

  // Returns the time of a frame of a moved camera with a row's setting, at the scene's size.
  double SettingMs(const PricedSettings& table, const PricedSetting& row,
                   const scene::Scene& scene) const;
  // Returns true if a full frame of that setting was observed.
  bool Knows(const Setting& setting) const { return correction_.Knows(setting); }

 private:
  // One model for each kind of technique, because their costs are unrelated.
  using Models = std::array<CostModel, std::variant_size_v<scene::Technique>>;
  // Names of technique, mode and transport; the context; whether traced paths correct the light.
  using Shaders = std::tuple<std::string, std::string, std::string_view, std::string_view, bool>;

  void CompareWithTable(const scene::Scene& scene, double view_ms);

  const OfferTables& tables_;
  std::set<Shaders> compiled_;
  Models machine_;
  std::map<std::string, Models> views_;  // by view; each starts as a copy of machine_
  TableCorrection correction_;
};

}  // namespace thunderhead::accuracy
