// The path of a scene from a client to its renderer, as far as it needs no device. Every fuzz
// target of scenes runs it on what it has decoded.
#pragma once

#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "scene/view.h"
#include "service/messages/camera_messages.h"
#include "service/messages/limits_check.h"
#include "service/messages/prepare_scene.h"
#include "service/messages/scene_messages.h"
#include "storm_store/storm_store.h"
#include "tests/support/technique_infos.h"

namespace thunderhead::fuzz {

// A store with one storm of a few cells, without a file.
class FixedStore final : public storm_store::StormStore {
 public:
  FixedStore() {
    auto info = std::make_shared<storm_store::StormInfo>();
    info->id = "storm";
    info->title = "A storm";
    info->times = {{"2013-05-20T20:00:00Z", 0.0}, {"2013-05-20T20:10:00Z", 600.0}};
    info->file_cells = {4, 3, 2};
    info->fields = {physics::Hydrometeor::kCloud, physics::Hydrometeor::kRain};
    info->latitude_deg = 35.0;
    info->longitude_deg = -97.0;
    info_ = std::move(info);
    auto fields = std::make_shared<volume::HydrometeorFields>();
    fields->grid = {{4, 3, 2}, {1000.0, 1000.0, 500.0}, {-2000.0, -1500.0, 0.0}};
    for (const physics::Hydrometeor hydrometeor : info_->fields) {
      volume::HydrometeorField field;
      field.hydrometeor = hydrometeor;
      field.concentration_kg_per_m3.assign(24, 1e-3F);
      fields->fields.push_back(field);
    }
    fields->terrain_height_m.assign(12, 100.0F);
    fields->condensate = {{0, 0, 0}, {4, 3, 2}};
    fields_ = std::move(fields);
  }
  std::vector<storm_store::StormInfoPtr> Storms() const override { return {info_}; }
  absl::StatusOr<storm_store::StormInfoPtr> Add(const std::string&) override {
    return absl::UnimplementedError("");
  }
  absl::Status Remove(std::string_view) override { return absl::UnimplementedError(""); }
  absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> Get(
      std::string_view, int, const storm_store::ReadProgress&) override {
    return fields_;
  }
  std::shared_ptr<const volume::HydrometeorFields> Peek(std::string_view, int) override {
    return fields_;
  }
  std::vector<int> TimesInMemory(std::string_view) const override { return {0, 1}; }
  std::size_t CachedBytes() const override { return 0; }

 private:
  storm_store::StormInfoPtr info_;
  std::shared_ptr<const volume::HydrometeorFields> fields_;
};

// Aborts if an accepted scene has a view that cannot be drawn.
inline void TakeScene(v1::Scene scene) {
  static FixedStore store;
  static const std::vector<scene::TechniqueInfo> techniques = test_support::TechniquesOfTheSchema();
  if (!service::CheckLimits(scene).ok()) return;
  if (!service::PrepareScene(store, techniques, scene).ok()) return;
  const auto fields = store.Peek("storm", 0);
  if (service::NeedsFraming(scene)) service::FrameCondensate(scene, *fields);
  const scene::View view = scene::ViewOf(service::ToScene(scene), *fields);
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(view.eye_m[axis]) || !std::isfinite(view.forward[axis])) std::abort();
  }
  // Serialises the scene as it is sent to viewers and stored.
  v1::Scene again;
  if (!again.ParseFromString(scene.SerializeAsString())) std::abort();
}

}  // namespace thunderhead::fuzz
