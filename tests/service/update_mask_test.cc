// Tests of update masks with paths that name no field. A client may send any text as a path.
#include <string>

#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/service/interacting.h"

namespace thunderhead::testing {
namespace {

using Stub = v1::ThunderheadService::Stub;

class UpdateMaskTest : public ::testing::Test {
 protected:
  grpc::Status Update(const std::string& path) {
    v1::UpdateSceneRequest update;
    update.set_session_id(session_);
    *update.mutable_scene() = SmallScene();
    update.mutable_update_mask()->add_paths(path);
    v1::UpdateSceneResponse updated;
    return Call(service_.stub(), &Stub::UpdateScene, update, &updated);
  }

  FakeService service_;
  const std::string session_ = service_.Open(SmallScene());
};

TEST_F(UpdateMaskTest, APathThatNamesNoFieldIsRefused) {
  for (const std::string path :
       {"", ".", "..", ".camera", "camera.", "camera..orbit", "camera.orbit.",
        "camera.orbit..azimuth_deg", "fields.", "fields.scale", "storm_id.", "storm_id.x",
        "output.width_px.", "rendering.other.numbers.key", "camera.orbit.nothing", "camera,orbit",
        "cameraOrbit", "camera.orbit.azimuth_deg.more"}) {
    const grpc::Status status = Update(path);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << path;
    EXPECT_NE(status.error_message().find("names '" + path + "'"), std::string::npos)
        << status.error_message();
  }
}

TEST_F(UpdateMaskTest, APathThatNamesAFieldIsAccepted) {
  for (const std::string path : {"camera", "camera.orbit", "camera.orbit.azimuth_deg", "fields",
                                 "storm_id", "output.width_px", "display.exposure_ev"}) {
    const grpc::Status status = Update(path);
    EXPECT_TRUE(status.ok()) << path << ": " << status.error_message();
  }
}

// The presenter may give control to any viewer. The server then accepts this viewer's updates like
// the presenter's.
TEST_F(UpdateMaskTest, AViewerInControlIsRefusedAndTheSessionGoesOn) {
  v1::CreateSessionRequest request;
  *request.mutable_scene() = SmallScene();
  v1::CreateSessionResponse session;
  ASSERT_TRUE(Call(service_.stub(), &Stub::CreateSession, request, &session).ok());
  Interacting presenter(service_.stub(), session.session_id());
  Interacting viewer(service_.stub(), session.viewer_key());
  viewer.AwaitNewest(v1::InteractResponse::kJoined);
  v1::InteractRequest gives;
  gives.mutable_give_control()->set_viewer_id(viewer.viewer_id());
  presenter.Send(gives);
  ASSERT_TRUE(viewer.AwaitPresence([&](const v1::Presence& presence) {
    return presence.steering_viewer_id() == viewer.viewer_id();
  }));
  for (const std::string path :
       {".", "..", "camera..orbit", "fields.", "rendering.other.numbers.x"}) {
    v1::InteractRequest update;
    *update.mutable_update_scene()->mutable_scene() = SmallScene();
    update.mutable_update_scene()->mutable_update_mask()->add_paths(path);
    EXPECT_EQ(viewer.AnswerCode(viewer.Send(update)), grpc::StatusCode::INVALID_ARGUMENT) << path;
    update.mutable_update_scene()->mutable_update_mask()->set_paths(0, "camera");
    EXPECT_EQ(viewer.AnswerCode(viewer.Send(update)), grpc::StatusCode::OK) << path;
  }
  viewer.Leave();
  EXPECT_TRUE(viewer.End().ok());
}

TEST_F(UpdateMaskTest, ControlCharactersOfAPathAreNotRepeated) {
  const grpc::Status status = Update("camera\nforged");
  EXPECT_NE(status.error_message().find("names 'camera?forged'"), std::string::npos)
      << status.error_message();
}

}  // namespace
}  // namespace thunderhead::testing
