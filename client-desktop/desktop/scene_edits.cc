#include "desktop/scene_edits.h"

#include <google/protobuf/util/message_differencer.h>

#include <algorithm>

namespace thunderhead::desktop {
namespace {

// Initial values of the two goals: a relative error (0.5 is 50 %) that every view can reach, and a
// time per frame that still gives smooth motion.
constexpr float kFirstError = 0.5F;
constexpr float kFirst_ms = 100.0F;

}  // namespace

void ChooseStorm(v1::Scene& scene, const std::string& storm_id) {
  if (scene.storm_id() == storm_id) return;
  scene.set_storm_id(storm_id);
  scene.clear_time_index();
  scene.clear_camera();
  scene.clear_fields();
  if (scene.has_sun()) scene.mutable_sun()->clear_clock();
}

void ChoosePreset(v1::Scene& scene, v1::Preset preset) {
  scene.mutable_rendering()->set_preset(preset);
  scene.set_particle_sizes(IsQuality(preset) ? v1::PARTICLE_SIZES_MODEL
                                             : v1::PARTICLE_SIZES_PAPERS);
  scene.clear_accuracy();
}

void ChooseParticleSizes(v1::Scene& scene, v1::ParticleSizes sizes) {
  scene.set_particle_sizes(sizes);
  for (v1::FieldParameters& field : *scene.mutable_fields()) {
    field.clear_sizes();
    field.clear_radius_m();
  }
}

void ChooseGoal(v1::Scene& scene, v1::Accuracy::LimitCase goal) {
  scene.clear_accuracy();
  if (goal == v1::Accuracy::kMaxError) scene.mutable_accuracy()->set_max_error(kFirstError);
  if (goal == v1::Accuracy::kMaxMilliseconds) {
    scene.mutable_accuracy()->set_max_milliseconds(kFirst_ms);
  }
}

bool IsQuality(v1::Preset preset) {
  return preset == v1::PRESET_FAST || preset == v1::PRESET_BALANCED ||
         preset == v1::PRESET_ACCURATE;
}

v1::Preset PresetOf(const v1::Scene& scene, const v1::GetServerInfoResponse& server) {
  if (scene.accuracy().limit_case() != v1::Accuracy::LIMIT_NOT_SET) return v1::PRESET_UNSPECIFIED;
  if (scene.rendering().has_preset()) return scene.rendering().preset();
  const auto& presets = server.presets();
  const auto found =
      std::find_if(presets.begin(), presets.end(), [&](const v1::PresetDescription& each) {
        return google::protobuf::util::MessageDifferencer::Equals(each.rendering(),
                                                                  scene.rendering());
      });
  return found == presets.end() ? v1::PRESET_UNSPECIFIED : found->preset();
}

}  // namespace thunderhead::desktop
