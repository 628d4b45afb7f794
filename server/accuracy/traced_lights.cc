#include "accuracy/traced_lights.h"

#include <utility>

#include "scene/scene_parts.h"

namespace thunderhead::accuracy {

bool SharesLight(const scene::Scene& traced, const scene::Scene& scene) {
  return scene::CapabilitiesOf(scene.rendering.technique).traced_light &&
         scene::Agree(traced, scene, &scene::ScenePart::light_correction);
}

std::optional<TracedLights::Found> TracedLights::Find(const scene::Scene& scene,
                                                      const Fields& fields) {
  if (scene::TracedLightOf(scene.rendering.technique) == scene::TracedLight::kOff) {
    return std::nullopt;
  }
  const std::lock_guard lock(mutex_);
  for (Entry* const entry : entries_) {
    if (entry->fields_ != fields || !SharesLight(entry->scene_, scene)) continue;
    entry->since_used_.Restart();
    if (entry->found_.correction == nullptr) return std::nullopt;
    return entry->found_;
  }
  return std::nullopt;
}

TracedLights::Entry::Entry(std::shared_ptr<TracedLights> lights, scene::Scene scene, Fields fields)
    : lights_(std::move(lights)), scene_(std::move(scene)), fields_(std::move(fields)) {
  const std::lock_guard lock(lights_->mutex_);
  lights_->entries_.push_back(this);
}

TracedLights::Entry::~Entry() {
  const std::lock_guard lock(lights_->mutex_);
  lights_->entries_.remove(this);
}

void TracedLights::Entry::Publish(Found found) {
  const std::lock_guard lock(lights_->mutex_);
  found_ = std::move(found);
  since_used_.Restart();
}

double TracedLights::Entry::UnusedMs() const {
  const std::lock_guard lock(lights_->mutex_);
  return since_used_.ElapsedMs();
}

}  // namespace thunderhead::accuracy
