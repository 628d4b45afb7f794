// The tool "Camera": the kind of camera, and its position and direction as numbers.
#include <imgui.h>

#include "desktop/controls.h"
#include "desktop/panels/panels.h"
#include "desktop/texts.h"

namespace thunderhead::desktop {
namespace {

using client::LimitsOf;

// Draws `control` for an azimuth. The control shows the azimuth from true north, but `azimuth_deg`
// counts from the grid's north. Returns true when the user has changed it.
bool Azimuth(const Ui& ui, bool (*control)(const char*, const client::Limits&, double&),
             const char* label, const client::Limits& limits, double& azimuth_deg) {
  double shown_deg = client::WrapDegrees(azimuth_deg - ui.true_north_deg());
  if (!control(label, limits, shown_deg)) return false;
  azimuth_deg = client::WrapDegrees(shown_deg + ui.true_north_deg());
  return true;
}

void OrbitControls(Ui& ui, client::OrbitPose pose) {
  bool changed =
      Azimuth(ui, Slider, "Seen from", LimitsOf<v1::OrbitCamera>("azimuth_deg"), pose.azimuth_deg);
  changed |= Slider("Height", LimitsOf<v1::OrbitCamera>("elevation_deg"), pose.elevation_deg);
  changed |= Slider("Distance", LimitsOf<v1::OrbitCamera>("distance_m"), pose.distance_m);
  changed |= Slider("Angle of view", LimitsOf<v1::OrbitCamera>("field_of_view_deg"),
                    pose.field_of_view_deg);
  if (changed) ui.ShowCamera(client::CameraOf(pose));
}

void SpotterControls(Ui& ui, client::SpotterPose pose) {
  using Camera = v1::SpotterCamera;
  bool changed = NumberField("East of the middle", LimitsOf<Camera>("x_m"), pose.place_m[0]);
  changed |= NumberField("North of the middle", LimitsOf<Camera>("y_m"), pose.place_m[1]);
  changed |=
      Azimuth(ui, NumberField, "Looks to", LimitsOf<Camera>("azimuth_deg"), pose.azimuth_deg);
  changed |= NumberField("Looks up", LimitsOf<Camera>("elevation_deg"), pose.elevation_deg);
  changed |= Slider("Lens", LimitsOf<Camera>("focal_length_mm"), pose.focal_length_mm);
  changed |= Slider("Height of the eye", LimitsOf<Camera>("eye_height_m"), pose.eye_height_m);
  if (changed) ui.ShowCamera(client::CameraOf(pose));
}

void TopDownControls(Ui& ui, client::TopDownPose pose) {
  using Camera = v1::TopDownCamera;
  bool changed = NumberField("East of the middle", LimitsOf<Camera>("x_m"), pose.center_m[0]);
  changed |= NumberField("North of the middle", LimitsOf<Camera>("y_m"), pose.center_m[1]);
  changed |= Slider("Width", LimitsOf<Camera>("width_m"), pose.width_m);
  if (changed) ui.ShowCamera(client::CameraOf(pose));
}

}  // namespace

void CameraTool(Ui& ui) {
  const v1::Camera camera = ui.state.ViewCamera();
  const bool may_move = ui.state.Steers() || ui.state.MayLookAround();
  ImGui::BeginDisabled(!may_move);
  int kind = static_cast<int>(camera.kind_case()) - static_cast<int>(v1::Camera::kOrbit);
  if (Segments("kind", {"Around", "From the\nground", "From\nabove"}, kind)) {
    ui.ShowCamera(client::HomeCamera(
        static_cast<v1::Camera::KindCase>(kind + static_cast<int>(v1::Camera::kOrbit))));
  }
  const auto pose = client::PoseOf(camera);
  if (!pose) {
    Quiet("Waiting for the first picture …");
  } else {
    Quiet(DescribePose(*pose, ui.true_north_deg()));
    ImGui::Spacing();
    if (const auto* orbit = std::get_if<client::OrbitPose>(&*pose)) OrbitControls(ui, *orbit);
    if (const auto* spotter = std::get_if<client::SpotterPose>(&*pose))
      SpotterControls(ui, *spotter);
    if (const auto* map = std::get_if<client::TopDownPose>(&*pose)) TopDownControls(ui, *map);
  }
  ImGui::Spacing();
  if (ImGui::Button("Whole storm")) ui.ShowCamera(client::HomeCamera(camera.kind_case()));
  ImGui::EndDisabled();
  if (!may_move) Quiet("The presenter has locked the view.");
}

}  // namespace thunderhead::desktop
