// Which of a storm's fields a scene shows: the rule that every renderer and the reference keep.
#pragma once

#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

// True if the field holds anything, is visible and is not scaled away.
bool IsDrawn(const Scene& scene, const volume::HydrometeorField& field);

}  // namespace thunderhead::scene
