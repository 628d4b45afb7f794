#include "desktop/scene_edits.h"

namespace thunderhead::desktop {
namespace {

// The others are the papers'.
bool IsQuality(v1::Preset preset) {
  return preset == v1::PRESET_FAST || preset == v1::PRESET_BALANCED || preset == v1::PRESET_TRUE;
}

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

}  // namespace thunderhead::desktop
