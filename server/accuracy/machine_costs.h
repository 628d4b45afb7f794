// The cost of frames on this machine, learnt from the frames that it draws: each is reported once,
// and both questions are answered from them: a view's next frame, and a setting of a table. Plain
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
  std::string_view context = {};  // of OpenGL, each of which compiles its own shaders
};

class MachineCosts {
 public:
  // `tables` must outlive it.
  explicit MachineCosts(const OfferTables& tables) : tables_(tables) {}

  // A frame of `view`, which names whose picture it is. The first frame of a setting in each
  // context counts for nothing: its time is not representative, as it includes shader compilation.
  void Observe(const std::string& view, const MeasuredFrame& frame);

  // The next frame of `view` if `first_dirty` is the first stage to rerun: by the frames of that
  // view, or of all where it has none yet. Views differ in how much of their storm they look
  // through.
  double FrameMs(const std::string& view, const scene::Scene& scene, const FrameQuality& quality,
                 scene::Stage first_dirty) const;
  void Forget(const std::string& view);

  // A frame of a moved camera with a row's setting, at the scene's size.
  double SettingMs(const PricedSettings& table, const PricedSetting& row,
                   const scene::Scene& scene) const;
  // True if a full frame of that setting was observed.
  bool Knows(const Setting& setting) const { return correction_.Knows(setting); }

 private:
  // One for each kind of technique: their costs have nothing in common.
  using Models = std::array<CostModel, std::variant_size_v<scene::Technique>>;
  // Names of technique, mode and transport; whether traced paths correct the light.
  using Shaders = std::tuple<std::string, std::string, std::string_view, std::string_view, bool>;

  void CompareWithTable(const scene::Scene& scene, double view_ms);

  const OfferTables& tables_;
  std::set<Shaders> compiled_;
  Models machine_;
  std::map<std::string, Models> views_;  // each begins with the machine's
  TableCorrection correction_;
};

}  // namespace thunderhead::accuracy
