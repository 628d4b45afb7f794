// Moves a camera in a load test.
#pragma once

#include <cmath>

#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::load {

// Turns an orbit camera by an angle.
inline void Turn(double angle_deg, v1::Camera& camera) {
  v1::OrbitCamera& orbit = *camera.mutable_orbit();
  orbit.set_azimuth_deg(static_cast<float>(std::remainder(orbit.azimuth_deg() + angle_deg, 360.0)));
}

}  // namespace thunderhead::load
