#include "thunderhead_client/pose.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "thunderhead_client/limits.h"

namespace thunderhead::client {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;
// Angle by which a drag across the picture's whole height turns the camera.
constexpr double kDegreesPerHeight = 180.0;
// Distance that a spotter walks for a drag across the picture's whole height.
constexpr double kWalkPerHeight_m = 20'000.0;
// Height of the film frame of 36 x 24 mm to which a spotter's focal length refers.
constexpr double kFrameHeight_mm = 24.0;

template <typename Message>
double Within(double value, const char* field) {
  return Clamp(value, LimitsOf<Message>(field));
}

template <typename Message>
double DefaultOf(const char* field) {
  return LimitsOf<Message>(field).default_value.value_or(0.0);
}

std::optional<Pose> OrbitOf(const v1::OrbitCamera& camera) {
  if (!camera.has_target() || !camera.has_elevation_deg() || !camera.has_distance_m()) return {};
  OrbitPose pose;
  pose.target_m = {camera.target().x_m(), camera.target().y_m(), camera.target().z_m()};
  pose.azimuth_deg =
      camera.has_azimuth_deg() ? camera.azimuth_deg() : DefaultOf<v1::OrbitCamera>("azimuth_deg");
  pose.elevation_deg = camera.elevation_deg();
  pose.distance_m = camera.distance_m();
  pose.field_of_view_deg = camera.has_field_of_view_deg()
                               ? camera.field_of_view_deg()
                               : DefaultOf<v1::OrbitCamera>("field_of_view_deg");
  return pose;
}

std::optional<Pose> SpotterOf(const v1::SpotterCamera& camera) {
  if (!camera.has_x_m() || !camera.has_y_m() || !camera.has_azimuth_deg() ||
      !camera.has_elevation_deg()) {
    return {};
  }
  SpotterPose pose;
  pose.place_m = {camera.x_m(), camera.y_m()};
  pose.eye_height_m = camera.has_eye_height_m() ? camera.eye_height_m()
                                                : DefaultOf<v1::SpotterCamera>("eye_height_m");
  pose.azimuth_deg = WrapDegrees(camera.azimuth_deg());
  pose.elevation_deg = camera.elevation_deg();
  pose.focal_length_mm = camera.has_focal_length_mm()
                             ? camera.focal_length_mm()
                             : DefaultOf<v1::SpotterCamera>("focal_length_mm");
  return pose;
}

std::optional<Pose> TopDownOf(const v1::TopDownCamera& camera) {
  if (!camera.has_x_m() || !camera.has_y_m() || !camera.has_width_m()) return {};
  return TopDownPose{{camera.x_m(), camera.y_m()}, camera.width_m()};
}

float Narrow(double value) { return static_cast<float>(value); }

void Fill(const OrbitPose& pose, v1::OrbitCamera& camera) {
  camera.mutable_target()->set_x_m(Narrow(Within<v1::Position>(pose.target_m[0], "x_m")));
  camera.mutable_target()->set_y_m(Narrow(Within<v1::Position>(pose.target_m[1], "y_m")));
  camera.mutable_target()->set_z_m(Narrow(Within<v1::Position>(pose.target_m[2], "z_m")));
  camera.set_azimuth_deg(Narrow(WrapDegrees(pose.azimuth_deg)));
  camera.set_elevation_deg(Narrow(Within<v1::OrbitCamera>(pose.elevation_deg, "elevation_deg")));
  camera.set_distance_m(Narrow(Within<v1::OrbitCamera>(pose.distance_m, "distance_m")));
  camera.set_field_of_view_deg(
      Narrow(Within<v1::OrbitCamera>(pose.field_of_view_deg, "field_of_view_deg")));
}

void Fill(const SpotterPose& pose, v1::SpotterCamera& camera) {
  using Camera = v1::SpotterCamera;
  camera.set_x_m(Narrow(Within<Camera>(pose.place_m[0], "x_m")));
  camera.set_y_m(Narrow(Within<Camera>(pose.place_m[1], "y_m")));
  camera.set_eye_height_m(Narrow(Within<Camera>(pose.eye_height_m, "eye_height_m")));
  camera.set_azimuth_deg(Narrow(WrapDegrees(pose.azimuth_deg)));
  camera.set_elevation_deg(Narrow(Within<Camera>(pose.elevation_deg, "elevation_deg")));
  camera.set_focal_length_mm(Narrow(Within<Camera>(pose.focal_length_mm, "focal_length_mm")));
}

void Fill(const TopDownPose& pose, v1::TopDownCamera& camera) {
  camera.set_x_m(Narrow(Within<v1::TopDownCamera>(pose.center_m[0], "x_m")));
  camera.set_y_m(Narrow(Within<v1::TopDownCamera>(pose.center_m[1], "y_m")));
  camera.set_width_m(Narrow(Within<v1::TopDownCamera>(pose.width_m, "width_m")));
}

void PanPose(OrbitPose& pose, double right_px, double down_px, const PictureSize& picture) {
  const double metres_per_px = 2.0 * pose.distance_m *
                               std::tan(pose.field_of_view_deg * kRadians / 2.0) /
                               std::max(1.0, picture.height_px);
  const double azimuth = pose.azimuth_deg * kRadians;
  const double elevation = pose.elevation_deg * kRadians;
  const std::array<double, 3> right{-std::cos(azimuth), std::sin(azimuth), 0.0};
  const std::array<double, 3> up{-std::sin(azimuth) * std::sin(elevation),
                                 -std::cos(azimuth) * std::sin(elevation), std::cos(elevation)};
  for (std::size_t i = 0; i < 3; ++i) {
    pose.target_m.at(i) += metres_per_px * (down_px * up.at(i) - right_px * right.at(i));
  }
}

void PanPose(SpotterPose& pose, double right_px, double down_px, const PictureSize& picture) {
  const double metres_per_px = kWalkPerHeight_m / std::max(1.0, picture.height_px);
  const double azimuth = pose.azimuth_deg * kRadians;
  const double right_m = -right_px * metres_per_px;
  const double forward_m = down_px * metres_per_px;
  pose.place_m[0] += right_m * std::cos(azimuth) + forward_m * std::sin(azimuth);
  pose.place_m[1] += forward_m * std::cos(azimuth) - right_m * std::sin(azimuth);
}

void PanPose(TopDownPose& pose, double right_px, double down_px, const PictureSize& picture) {
  const double metres_per_px = pose.width_m / std::max(1.0, picture.width_px);
  pose.center_m[0] -= right_px * metres_per_px;
  pose.center_m[1] += down_px * metres_per_px;
}

}  // namespace

std::optional<Pose> PoseOf(const v1::Camera& camera) {
  switch (camera.kind_case()) {
    case v1::Camera::kOrbit:
      return OrbitOf(camera.orbit());
    case v1::Camera::kSpotter:
      return SpotterOf(camera.spotter());
    case v1::Camera::kTopDown:
      return TopDownOf(camera.top_down());
    case v1::Camera::KIND_NOT_SET:
      break;
  }
  return {};
}

v1::Camera CameraOf(const Pose& pose) {
  v1::Camera camera;
  if (const auto* orbit = std::get_if<OrbitPose>(&pose)) Fill(*orbit, *camera.mutable_orbit());
  if (const auto* spotter = std::get_if<SpotterPose>(&pose)) {
    Fill(*spotter, *camera.mutable_spotter());
  }
  if (const auto* map = std::get_if<TopDownPose>(&pose)) Fill(*map, *camera.mutable_top_down());
  return camera;
}

v1::Camera HomeCamera(v1::Camera::KindCase kind) {
  v1::Camera camera;
  if (kind == v1::Camera::kSpotter) {
    camera.mutable_spotter();
  } else if (kind == v1::Camera::kTopDown) {
    camera.mutable_top_down();
  } else {
    camera.mutable_orbit();
  }
  return camera;
}

Pose Drag(Pose pose, double right_px, double down_px, const PictureSize& picture) {
  const double height_px = std::max(1.0, picture.height_px);
  if (std::holds_alternative<OrbitPose>(pose)) {
    const double degrees_per_px = kDegreesPerHeight / height_px;
    return Turn(pose, right_px * degrees_per_px, down_px * degrees_per_px);
  }
  if (const auto* spotter = std::get_if<SpotterPose>(&pose)) {
    const double degrees_per_px = kFrameHeight_mm / spotter->focal_length_mm / height_px / kRadians;
    return Turn(pose, -right_px * degrees_per_px, down_px * degrees_per_px);
  }
  return Pan(pose, right_px, down_px, picture);
}

Pose Turn(Pose pose, double azimuth_deg, double elevation_deg) {
  const auto turn = [&](auto& turned) {
    turned.azimuth_deg = WrapDegrees(turned.azimuth_deg + azimuth_deg);
    turned.elevation_deg =
        Within<v1::OrbitCamera>(turned.elevation_deg + elevation_deg, "elevation_deg");
  };
  if (auto* orbit = std::get_if<OrbitPose>(&pose)) turn(*orbit);
  if (auto* spotter = std::get_if<SpotterPose>(&pose)) turn(*spotter);
  return pose;
}

Pose Pan(Pose pose, double right_px, double down_px, const PictureSize& picture) {
  std::visit([&](auto& panned) { PanPose(panned, right_px, down_px, picture); }, pose);
  return pose;
}

Pose Zoom(Pose pose, double factor) {
  if (auto* orbit = std::get_if<OrbitPose>(&pose)) {
    orbit->distance_m = Within<v1::OrbitCamera>(orbit->distance_m * factor, "distance_m");
  }
  if (auto* spotter = std::get_if<SpotterPose>(&pose)) {
    spotter->focal_length_mm =
        Within<v1::SpotterCamera>(spotter->focal_length_mm / factor, "focal_length_mm");
  }
  if (auto* map = std::get_if<TopDownPose>(&pose)) {
    map->width_m = Within<v1::TopDownCamera>(map->width_m * factor, "width_m");
  }
  return pose;
}

double WrapDegrees(double degrees) {
  const double wrapped = std::fmod(degrees, 360.0);
  return wrapped < 0.0 ? wrapped + 360.0 : wrapped;
}

}  // namespace thunderhead::client
