// Converts cameras between messages and values. If a camera message sets no position, places the
// camera so that it frames the storm.
#pragma once

#include "scene/scene.h"
#include "scene/view.h"
#include "thunderhead/v1/frame.pb.h"
#include "thunderhead/v1/scene.pb.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::service {

// Returns true if the camera lacks a setting whose default depends on the storm's fields.
bool NeedsFraming(const v1::Scene& scene);

// Fills in absent positions, distances and directions of the camera, so that the picture frames the
// visible part of `fields` (volume::VisibleBox). A spotter camera looks at the strongest core of
// the storm instead, if there is one (volume::StrongestCore).
void FrameCondensate(v1::Scene& scene, const volume::HydrometeorFields& fields);

// Converts a camera message whose defaults are filled in.
scene::Camera ToCamera(const v1::Camera& message);

void ToMessage(const scene::Camera& camera, v1::Camera& message);
void ToMessage(const scene::View& view, v1::View& message);
void SetPosition(const glm::dvec3& position_m, v1::Position& message);

}  // namespace thunderhead::service
