#include "accuracy/machine_costs.h"

#include <optional>

#include "accuracy/named_settings.h"

namespace thunderhead::accuracy {

void MachineCosts::Observe(const std::string& view, const MeasuredFrame& frame) {
  const scene::Technique& technique = frame.scene.rendering.technique;
  const bool compiles =
      compiled_
          .emplace(std::string(frame.context), scene::NameOf(technique), ModeOf(technique).name,
                   TransportNameOf(technique), frame.traced)
          .second;
  if (compiles) return;
  const double mega_samples = MegaSamples(frame.scene, frame.quality);
  Models& own = views_.try_emplace(view, machine_).first->second;
  for (Models* const models : {&own, &machine_}) {
    (*models)[technique.index()].Observe(mega_samples, frame.total_ms, frame.stages);
  }
  const std::optional<double> view_ms = ViewMs(frame.total_ms, frame.stages);
  if (frame.quality == FrameQuality{} && view_ms.has_value()) {
    CompareWithTable(frame.scene, *view_ms);
  }
}

void MachineCosts::CompareWithTable(const scene::Scene& scene, double view_ms) {
  const auto& table = TableFor(tables_, scene);
  if (!table.ok()) return;
  const Setting setting = Untraced(SettingOf(scene));
  const PricedSetting* const row = NearestRow(*table, setting);
  // The measured time is compared only with a row of exactly this setting. With the nearest other
  // row, the ratio of the times would also contain the difference between the two settings.
  if (row == nullptr || Distance(row->setting, setting) > 0.0) return;
  correction_.Observe(setting, TableMs(*table, *row, scene), view_ms);
}

double MachineCosts::FrameMs(const std::string& view, const scene::Scene& scene,
                             const FrameQuality& quality, scene::Stage first_dirty) const {
  const auto own = views_.find(view);
  const Models& models = own != views_.end() ? own->second : machine_;
  return models[scene.rendering.technique.index()].EstimateMs(MegaSamples(scene, quality),
                                                              first_dirty);
}

void MachineCosts::Forget(const std::string& view) { views_.erase(view); }

double MachineCosts::SettingMs(const PricedSettings& table, const PricedSetting& row,
                               const scene::Scene& scene) const {
  return TableMs(table, row, scene) * correction_.Factor(row.setting);
}

}  // namespace thunderhead::accuracy
