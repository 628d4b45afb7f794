// Cameras as messages and values, and the framing of what a camera message leaves open.
#pragma once

#include "scene/scene.h"
#include "thunderhead/v1/scene.pb.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::service {

// True if the camera's defaults depend on where the storm is.
bool NeedsFraming(const v1::Scene& scene);

// Fills in where the camera stands and looks, where absent, so that what is to be seen of `fields`
// (volume::VisibleBox) is framed.
void FrameCondensate(v1::Scene& scene, const volume::HydrometeorFields& fields);

// The value of a camera whose defaults are filled in.
scene::Camera ToCamera(const v1::Camera& message);

void ToMessage(const scene::Camera& camera, v1::Camera& message);
void SetPosition(const glm::dvec3& position_m, v1::Position& message);

}  // namespace thunderhead::service
