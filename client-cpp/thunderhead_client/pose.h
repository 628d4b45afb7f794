// Camera motions: how a drag in pixels moves and turns each kind of camera. The world axes are
// those of thunderhead/v1/scene.proto. The x axis points to the grid's east, y to its north and z
// up; the azimuth is clockwise from the grid's north. Pixel distances are positive to the right and
// down.
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

// A camera that stands on the ground and looks to an azimuth and an elevation.
struct SpotterPose {
  std::array<double, 2> place_m{};
  double eye_height_m = 0.0;
  double azimuth_deg = 0.0;
  double elevation_deg = 0.0;
  double focal_length_mm = 0.0;
};

// A camera that looks straight down, with north up.
struct TopDownPose {
  std::array<double, 2> center_m{};
  double width_m = 0.0;
};

using Pose = std::variant<OrbitPose, SpotterPose, TopDownPose>;

struct PictureSize {
  double width_px = 1.0;
  double height_px = 1.0;
};

// Returns the pose of a camera whose values the server has filled in; nothing while some are
// missing.
std::optional<Pose> PoseOf(const v1::Camera& camera);
// Returns the camera of a pose, with every value clamped to its limits.
v1::Camera CameraOf(const Pose& pose);
// Returns a camera of that kind with no values set. The server then chooses values that show the
// whole storm.
v1::Camera HomeCamera(v1::Camera::KindCase kind);

// Turns or moves the camera so that the scene follows the pointer. An orbit camera turns around its
// target, a spotter turns its head, and a top-down camera moves.
Pose Drag(Pose pose, double right_px, double down_px, const PictureSize& picture);
// Turns an orbit camera around its target, clockwise as seen from above, and up. Turns a spotter's
// head to the right and up. A top-down camera cannot turn.
Pose Turn(Pose pose, double azimuth_deg, double elevation_deg);
// Moves an orbit camera or a top-down camera perpendicular to the line of sight, so that points at
// the target's distance follow the pointer. A spotter walks instead: to the left for a drag to the
// right, and backwards for a drag up.
Pose Pan(Pose pose, double right_px, double down_px, const PictureSize& picture);
// Zooms in if the factor is below 1. An orbit camera moves nearer, a spotter uses a longer lens,
// and a top-down camera shows a smaller area.
Pose Zoom(Pose pose, double factor);

// Returns the same azimuth in the range from 0 to below 360 degrees.
double WrapDegrees(double degrees);

}  // namespace thunderhead::client
