#include <memory>

#include "client-cpp/tests/cases/runners.h"
#include "thunderhead_client/pose.h"

namespace thunderhead::client::testing {
namespace {

struct Viewpoint {
  // Moves the camera if it has a pose, and returns the camera afterwards.
  template <typename Motion>
  Results Move(const Motion& motion) {
    if (!pose) return {{"camera", Null()}};
    pose = motion(*pose);
    return {{"camera", JsonOf(CameraOf(*pose))}};
  }

  std::optional<Pose> pose;
  PictureSize picture;
};

v1::Camera::KindCase KindOf(const std::string& name) {
  if (name == "orbit") return v1::Camera::kOrbit;
  if (name == "spotter") return v1::Camera::kSpotter;
  if (name == "topDown") return v1::Camera::kTopDown;
  throw CaseError("the runner does not know the kind '" + name + "'");
}

}  // namespace

Actions RunCamera(Arguments& given) {
  const auto viewpoint = std::make_shared<Viewpoint>();
  viewpoint->pose = PoseOf(given.Read<v1::Camera>("camera"));
  Arguments picture(given.Get("picture").struct_value());
  viewpoint->picture = {picture.Number("width_px"), picture.Number("height_px")};
  picture.ExpectAllRead();
  Actions actions;
  actions["read"] = [=](Arguments&) {
    return viewpoint->Move([](const Pose& pose) { return pose; });
  };
  actions["drag"] = [=](Arguments& step) {
    const double right_px = step.Number("right_px");
    const double down_px = step.Number("down_px");
    return viewpoint->Move(
        [&](const Pose& pose) { return Drag(pose, right_px, down_px, viewpoint->picture); });
  };
  actions["pan"] = [=](Arguments& step) {
    const double right_px = step.Number("right_px");
    const double down_px = step.Number("down_px");
    return viewpoint->Move(
        [&](const Pose& pose) { return Pan(pose, right_px, down_px, viewpoint->picture); });
  };
  actions["turn"] = [=](Arguments& step) {
    const double azimuth_deg = step.Number("azimuth_deg");
    const double elevation_deg = step.Number("elevation_deg");
    return viewpoint->Move(
        [&](const Pose& pose) { return Turn(pose, azimuth_deg, elevation_deg); });
  };
  actions["zoom"] = [=](Arguments& step) {
    const double factor = step.Number("factor");
    return viewpoint->Move([&](const Pose& pose) { return Zoom(pose, factor); });
  };
  actions["home"] = [](Arguments& step) -> Results {
    return {{"camera", JsonOf(HomeCamera(KindOf(step.Text("kind"))))}};
  };
  return actions;
}

}  // namespace thunderhead::client::testing
