// Camera motions: how a drag in pixels moves and turns each kind of camera. World axes as in
// thunderhead/v1/scene.proto: x east, y north, z up, azimuth clockwise from north. Pixels count
// right and down.
#pragma once

#include <array>
#include <optional>
#include <variant>

#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::client {

struct OrbitPose {
  std::array<double, 3> target_m{};
  double azimuth_deg = 0.0;
  double elevation_deg = 0.0;
  double distance_m = 0.0;
  double field_of_view_deg = 0.0;
};

// Stands on the ground and looks to azimuth and elevation.
struct SpotterPose {
  std::array<double, 2> place_m{};
  double eye_height_m = 0.0;
  double azimuth_deg = 0.0;
  double elevation_deg = 0.0;
  double focal_length_mm = 0.0;
};

// Looks straight down, north up.
struct TopDownPose {
  std::array<double, 2> center_m{};
  double width_m = 0.0;
};

using Pose = std::variant<OrbitPose, SpotterPose, TopDownPose>;

struct PictureSize {
  double width_px = 1.0;
  double height_px = 1.0;
};

// The pose of a camera with every value filled in by the server; nothing while some are missing.
std::optional<Pose> PoseOf(const v1::Camera& camera);
// Every value within its limits.
v1::Camera CameraOf(const Pose& pose);
// A camera of that kind with nothing set: the server frames the whole storm.
v1::Camera HomeCamera(v1::Camera::KindCase kind);

// The scene follows the pointer: an orbit camera goes around, a spotter turns its head, a map
// moves.
Pose Drag(Pose pose, double right_px, double down_px, const PictureSize& picture);
// Turns an orbit camera around its target, clockwise seen from above, and up; a spotter's head to
// the right and up. A map cannot turn.
Pose Turn(Pose pose, double azimuth_deg, double elevation_deg);
// Moves the camera across the line of sight, so that points at the target's distance follow the
// pointer. A spotter walks instead: left for a drag to the right, backwards for a drag up.
Pose Pan(Pose pose, double right_px, double down_px, const PictureSize& picture);
// Below 1 shows things larger: an orbit camera comes nearer, a spotter takes a longer lens, a map
// shows less.
Pose Zoom(Pose pose, double factor);

// The same azimuth from 0 to below 360 degrees.
double WrapDegrees(double degrees);

}  // namespace thunderhead::client
