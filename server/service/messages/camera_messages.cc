#include "service/messages/camera_messages.h"

#include <algorithm>
#include <variant>

#include "scene/spotter_place.h"
#include "scene/view.h"
#include "service/messages/scene_messages.h"
#include "thunderhead/v1/limits.pb.h"
#include "volume/strongest_core.h"
#include "volume/visible_box.h"

namespace thunderhead::service {
namespace {

scene::OrbitCamera ToOrbit(const v1::OrbitCamera& message) {
  scene::OrbitCamera camera;
  camera.target_m = {message.target().x_m(), message.target().y_m(), message.target().z_m()};
  camera.azimuth_deg = message.azimuth_deg();
  camera.elevation_deg = message.elevation_deg();
  camera.distance_m = message.distance_m();
  camera.field_of_view_deg = message.field_of_view_deg();
  return camera;
}

scene::SpotterCamera ToSpotter(const v1::SpotterCamera& message) {
  return {{message.x_m(), message.y_m()},
          message.eye_height_m(),
          message.azimuth_deg(),
          message.elevation_deg(),
          message.focal_length_mm()};
}

scene::TopDownCamera ToTopDown(const v1::TopDownCamera& message) {
  return {{message.x_m(), message.y_m()}, message.width_m()};
}

// Clamps `value` to the limits of the message's field.
float WithinLimits(const google::protobuf::Descriptor& message, const char* field, double value) {
  const auto& limits = message.FindFieldByName(field)->options().GetExtension(v1::number);
  return static_cast<float>(std::clamp(value, limits.minimum(), limits.maximum()));
}

void Frame(v1::OrbitCamera& camera, const volume::WorldBox& box, double aspect_ratio) {
  if (!camera.has_elevation_deg()) {
    camera.set_elevation_deg(
        static_cast<float>(scene::FramingElevation_deg(box.low_m, box.high_m)));
  }
  const scene::OrbitCamera framing =
      scene::Framing(ToOrbit(camera), box.low_m, box.high_m, aspect_ratio);
  if (!camera.has_target()) SetPosition(framing.target_m, *camera.mutable_target());
  if (camera.has_distance_m()) return;
  camera.set_distance_m(WithinLimits(*camera.GetDescriptor(), "distance_m", framing.distance_m));
}

// Returns the default position and direction of a spotter camera whose message lacks one or both of
// its coordinates.
scene::SpotterCamera Placed(const v1::SpotterCamera& message,
                            const volume::HydrometeorFields& fields, const volume::StormCore& core,
                            physics::SizeSource sizes, const v1::Sun& sun, double aspect_ratio) {
  scene::SpotterCamera camera = ToSpotter(message);
  const bool looks_somewhere = message.has_azimuth_deg();
  if (!looks_somewhere) camera.azimuth_deg = scene::SpotterCamera().azimuth_deg;
  camera = scene::SpottingCore(
      camera, looks_somewhere ? scene::SpottersSide::kOppositeAzimuth : scene::SpottersSide::kBest,
      fields, core, sizes, scene::Direction(sun.azimuth_deg(), sun.elevation_deg()), aspect_ratio);
  if (!message.has_x_m() && !message.has_y_m()) return camera;
  if (message.has_x_m()) camera.place_m.x = message.x_m();
  if (message.has_y_m()) camera.place_m.y = message.y_m();
  return scene::LookingAt(camera, fields, core, aspect_ratio);
}

void Frame(v1::SpotterCamera& camera, const volume::HydrometeorFields& fields,
           physics::SizeSource sizes, const v1::Sun& sun, double aspect_ratio) {
  const bool has_place = camera.has_x_m() && camera.has_y_m();
  scene::SpotterCamera framing = ToSpotter(camera);
  if (const auto core = volume::StrongestCore(fields, sizes); core.has_value() && !has_place) {
    framing = Placed(camera, fields, *core, sizes, sun, aspect_ratio);
  } else {
    const volume::WorldBox box = volume::VisibleBox(fields, sizes);
    if (!camera.has_azimuth_deg()) framing.azimuth_deg = scene::SpotterCamera().azimuth_deg;
    if (!has_place) framing = scene::Framing(framing, box.low_m, box.high_m, aspect_ratio);
    if (camera.has_x_m()) framing.place_m.x = camera.x_m();
    if (camera.has_y_m()) framing.place_m.y = camera.y_m();
    framing = scene::LookingAt(framing, box.low_m, box.high_m);
  }
  if (!camera.has_x_m()) camera.set_x_m(static_cast<float>(framing.place_m.x));
  if (!camera.has_y_m()) camera.set_y_m(static_cast<float>(framing.place_m.y));
  if (!camera.has_azimuth_deg()) camera.set_azimuth_deg(static_cast<float>(framing.azimuth_deg));
  if (!camera.has_elevation_deg()) {
    camera.set_elevation_deg(static_cast<float>(framing.elevation_deg));
  }
}

void Frame(v1::TopDownCamera& camera, const volume::WorldBox& box, double aspect_ratio) {
  const scene::TopDownCamera framing =
      scene::Framing(ToTopDown(camera), box.low_m, box.high_m, aspect_ratio);
  if (!camera.has_x_m()) camera.set_x_m(static_cast<float>(framing.center_m.x));
  if (!camera.has_y_m()) camera.set_y_m(static_cast<float>(framing.center_m.y));
  if (camera.has_width_m()) return;
  camera.set_width_m(WithinLimits(*camera.GetDescriptor(), "width_m", framing.width_m));
}

void SetCamera(const scene::OrbitCamera& camera, v1::Camera& message) {
  v1::OrbitCamera& orbit = *message.mutable_orbit();
  SetPosition(camera.target_m, *orbit.mutable_target());
  orbit.set_azimuth_deg(static_cast<float>(camera.azimuth_deg));
  orbit.set_elevation_deg(static_cast<float>(camera.elevation_deg));
  orbit.set_distance_m(static_cast<float>(camera.distance_m));
  orbit.set_field_of_view_deg(static_cast<float>(camera.field_of_view_deg));
}

void SetCamera(const scene::SpotterCamera& camera, v1::Camera& message) {
  v1::SpotterCamera& spotter = *message.mutable_spotter();
  spotter.set_x_m(static_cast<float>(camera.place_m.x));
  spotter.set_y_m(static_cast<float>(camera.place_m.y));
  spotter.set_eye_height_m(static_cast<float>(camera.eye_height_m));
  spotter.set_azimuth_deg(static_cast<float>(camera.azimuth_deg));
  spotter.set_elevation_deg(static_cast<float>(camera.elevation_deg));
  spotter.set_focal_length_mm(static_cast<float>(camera.focal_length_mm));
}

void SetCamera(const scene::TopDownCamera& camera, v1::Camera& message) {
  v1::TopDownCamera& top_down = *message.mutable_top_down();
  top_down.set_x_m(static_cast<float>(camera.center_m.x));
  top_down.set_y_m(static_cast<float>(camera.center_m.y));
  top_down.set_width_m(static_cast<float>(camera.width_m));
}

}  // namespace

bool NeedsFraming(const v1::Scene& scene) {
  const v1::Camera& camera = scene.camera();
  switch (camera.kind_case()) {
    case v1::Camera::kSpotter:
      return !camera.spotter().has_x_m() || !camera.spotter().has_y_m() ||
             !camera.spotter().has_azimuth_deg() || !camera.spotter().has_elevation_deg();
    case v1::Camera::kTopDown:
      return !camera.top_down().has_x_m() || !camera.top_down().has_y_m() ||
             !camera.top_down().has_width_m();
    default:
      return !camera.orbit().has_target() || !camera.orbit().has_elevation_deg() ||
             !camera.orbit().has_distance_m();
  }
}

void FrameCondensate(v1::Scene& scene, const volume::HydrometeorFields& fields) {
  v1::Camera& camera = *scene.mutable_camera();
  const physics::SizeSource sizes = SizesOf(scene);
  const double aspect_ratio =
      static_cast<double>(scene.output().width_px()) / scene.output().height_px();
  if (camera.has_spotter()) {
    Frame(*camera.mutable_spotter(), fields, sizes, scene.sun(), aspect_ratio);
  } else if (camera.has_top_down()) {
    Frame(*camera.mutable_top_down(), volume::VisibleBox(fields, sizes), aspect_ratio);
  } else {
    Frame(*camera.mutable_orbit(), volume::VisibleBox(fields, sizes), aspect_ratio);
  }
}

scene::Camera ToCamera(const v1::Camera& message) {
  switch (message.kind_case()) {
    case v1::Camera::kSpotter:
      return ToSpotter(message.spotter());
    case v1::Camera::kTopDown:
      return ToTopDown(message.top_down());
    default:
      return ToOrbit(message.orbit());
  }
}

void ToMessage(const scene::Camera& camera, v1::Camera& message) {
  std::visit([&message](const auto& kind) { SetCamera(kind, message); }, camera);
}

void ToMessage(const scene::View& view, v1::View& message) {
  const auto set = [](const glm::dvec3& value, v1::Vector& vector) {
    vector.set_x(static_cast<float>(value.x));
    vector.set_y(static_cast<float>(value.y));
    vector.set_z(static_cast<float>(value.z));
  };
  const bool parallel = view.Orthographic();
  SetPosition(view.eye_m, *message.mutable_eye());
  set(view.forward, *message.mutable_forward());
  set((parallel ? view.half_width_m : view.tan_half_width) * view.right, *message.mutable_right());
  set((parallel ? view.half_height_m : view.tan_half_height) * view.up, *message.mutable_up());
  message.set_parallel(parallel);
}

void SetPosition(const glm::dvec3& position_m, v1::Position& message) {
  message.set_x_m(static_cast<float>(position_m.x));
  message.set_y_m(static_cast<float>(position_m.y));
  message.set_z_m(static_cast<float>(position_m.z));
}

}  // namespace thunderhead::service
