// Tests that every rpc checks its request against the limits of the schema.
#include <string>

#include "gtest/gtest.h"
#include "tests/service/fake_service.h"

namespace thunderhead::testing {
namespace {

using Stub = v1::ThunderheadService::Stub;

TEST(CheckedRequests, NameTheFieldTheValueAndItsRange) {
  FakeService service;
  v1::Scene scene = SmallScene();
  scene.mutable_display()->set_exposure_ev(21);
  const std::string complaint = "scene.display.exposure_ev is 21; it must be between -20 and 20";
  const auto expect = [&](const grpc::Status& status, const std::string& text) {
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(status.error_message(), text);
  };
  v1::CreateSessionRequest create;
  *create.mutable_scene() = scene;
  v1::CreateSessionResponse created;
  expect(Call(service.stub(), &Stub::CreateSession, create, &created), complaint);
  v1::UpdateSceneRequest update;
  update.set_session_id(service.Open(SmallScene()));
  *update.mutable_scene() = scene;
  v1::UpdateSceneResponse updated;
  expect(Call(service.stub(), &Stub::UpdateScene, update, &updated), complaint);
  v1::RenderImageRequest render;
  *render.mutable_scene() = scene;
  v1::RenderImageResponse rendered;
  expect(Call(service.stub(), &Stub::RenderImage, render, &rendered), complaint);
  render.clear_scene();
  render.set_format(static_cast<v1::ImageFormat>(9));
  expect(Call(service.stub(), &Stub::RenderImage, render, &rendered),
         "format is 9; it must be one of IMAGE_FORMAT_UNSPECIFIED, IMAGE_FORMAT_PNG, "
         "IMAGE_FORMAT_JPEG, IMAGE_FORMAT_EXR");
  v1::DescribeStormRequest describe;
  describe.set_time_index(2000000);
  v1::DescribeStormResponse described;
  expect(Call(service.stub(), &Stub::DescribeStorm, describe, &described),
         "time_index is 2000000; it must be between 0 and 1e+06");
  v1::CloseSessionRequest close;
  close.set_session_id(std::string(65, 'a'));
  v1::CloseSessionResponse closed;
  expect(Call(service.stub(), &Stub::CloseSession, close, &closed),
         "session_id is 65 bytes long; it may be at most 64 bytes");
  v1::AcknowledgeFrameRequest acknowledge;
  acknowledge.set_session_id(std::string(65, 'a'));
  v1::AcknowledgeFrameResponse acknowledged;
  expect(Call(service.stub(), &Stub::AcknowledgeFrame, acknowledge, &acknowledged),
         "session_id is 65 bytes long; it may be at most 64 bytes");
  Watcher watcher(service.stub(), std::string(65, 'a'));
  expect(watcher.End(), "session_id is 65 bytes long; it may be at most 64 bytes");
}

}  // namespace
}  // namespace thunderhead::testing
