// Tests of single pictures.
#include "frame/image_codec.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;
using Stub = v1::ThunderheadService::Stub;

grpc::Status Render(FakeService& service, const v1::RenderImageRequest& request,
                    v1::RenderImageResponse* response) {
  return Call(service.stub(), &Stub::RenderImage, request, response);
}

TEST(RenderImageTest, PngHoldsEveryPixelAtFullQuality) {
  FakeService service;
  v1::RenderImageRequest request;
  *request.mutable_scene() = SmallScene();
  request.mutable_scene()->set_time_index(1);
  request.mutable_scene()->mutable_sun()->set_azimuth_deg(255.0F);
  v1::RenderImageResponse response;
  const grpc::Status status = Render(service, request, &response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(response.format(), v1::IMAGE_FORMAT_PNG);
  EXPECT_EQ(response.width_px(), 64U);
  const auto image = frame::DecodePng(response.image());
  ASSERT_TRUE(image.ok()) << image.status();
  ASSERT_EQ(image->rgb.size(), 64U * 36U * 3U);
  EXPECT_EQ(image->rgb[0], RedOf(1));
  EXPECT_EQ(image->rgb[1], GreenOf(255.0));
  EXPECT_EQ(response.modelled().slices(), 16U);
  EXPECT_EQ(response.stages(0).stage(), v1::STAGE_READ);
  EXPECT_EQ(response.stages(response.stages_size() - 1).stage(), v1::STAGE_ENCODE);
  EXPECT_EQ(response.scene().storm_id(), "anvil");
  EXPECT_TRUE(response.scene().camera().orbit().has_distance_m());
  EXPECT_EQ(service.machine->Log().at(0).quality, accuracy::FrameQuality{});
}

TEST(RenderImageTest, JpegOnRequest) {
  FakeService service;
  v1::RenderImageRequest request;
  *request.mutable_scene() = SmallScene();
  request.set_format(v1::IMAGE_FORMAT_JPEG);
  v1::RenderImageResponse response;
  ASSERT_TRUE(Render(service, request, &response).ok());
  EXPECT_EQ(response.format(), v1::IMAGE_FORMAT_JPEG);
  EXPECT_EQ(frame::DecodeJpeg(response.image())->width_px, 64);
}

TEST(RenderImageTest, ErrorsOfReadingAndDrawingComeBack) {
  FakeService service;
  service.store->FailAt(1, absl::DataLossError("wrfout_1: QRAIN is truncated"));
  service.machine->fails_above_exposure_ev = 5.0;
  v1::RenderImageRequest request;
  *request.mutable_scene() = SmallScene();
  request.mutable_scene()->set_time_index(1);
  v1::RenderImageResponse response;
  grpc::Status status = Render(service, request, &response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::DATA_LOSS);
  EXPECT_EQ(status.error_message(), "wrfout_1: QRAIN is truncated");
  request.mutable_scene()->set_time_index(0);
  request.mutable_scene()->mutable_display()->set_exposure_ev(6);
  status = Render(service, request, &response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INTERNAL);
  EXPECT_THAT(status.error_message(), HasSubstr("does not like this exposure"));
  request.mutable_scene()->set_storm_id("hurricane");
  EXPECT_EQ(Render(service, request, &response).error_code(), grpc::StatusCode::NOT_FOUND);
}

// A request that renders on its own thread.
class Request {
 public:
  Request(FakeService& service, float exposure_ev, std::uint32_t time_index = 0) {
    thread_ = std::thread([this, &service, exposure_ev, time_index] {
      v1::RenderImageRequest request;
      *request.mutable_scene() = SmallScene();
      request.mutable_scene()->set_time_index(time_index);
      request.mutable_scene()->mutable_display()->set_exposure_ev(exposure_ev);
      v1::RenderImageResponse response;
      status_ = service.stub().RenderImage(&context_, request, &response);
      ended_ = true;
    });
  }
  ~Request() {
    if (thread_.joinable()) thread_.join();
  }

  void Cancel() { context_.TryCancel(); }
  bool HasEnded() const { return ended_; }
  grpc::Status End() {
    thread_.join();
    return status_;
  }

 private:
  grpc::ClientContext context_;
  grpc::Status status_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

// The storms of two pictures are read meanwhile, one picture by each worker (drawing thread).
TEST(RenderImageTest, CancelledPictureIsNeverDrawn) {
  FakeService service;
  service.store->reading.Close();
  Request first(service, 1.0F, 0);
  Request other(service, 1.0F, 2);
  ASSERT_TRUE(service.store->reading.AwaitWaiting(2));
  Request second(service, 2.0F, 1);
  ASSERT_TRUE(WaitFor([&] { return service.server().Load().waiting_pictures == 1; }));
  second.Cancel();
  EXPECT_EQ(second.End().error_code(), grpc::StatusCode::CANCELLED);
  // The server notices the cancellation a moment after the client has ended the call.
  ASSERT_TRUE(WaitFor([&] { return service.server().Load().pictures == 2; }));
  service.store->reading.Open();
  EXPECT_TRUE(first.End().ok());
  EXPECT_TRUE(other.End().ok());
  Request third(service, 3.0F);
  EXPECT_TRUE(third.End().ok());
  for (const auto& drawn : service.machine->Log()) EXPECT_NE(drawn.scene.display.exposure_ev, 2.0);
}

TEST(RenderImageTest, TooManyWaitingPicturesAreRefused) {
  service::ServerOptions options = Patient();
  options.render_loop.max_waiting_images = 1;
  FakeService service(options);
  service.machine->drawing.Close();
  Request drawn(service, 1.0F);
  ASSERT_TRUE(service.machine->drawing.AwaitWaiting(1));
  std::vector<std::unique_ptr<Request>> others;
  others.push_back(std::make_unique<Request>(service, 2.0F, 1));
  others.push_back(std::make_unique<Request>(service, 3.0F, 2));
  // While the first picture is drawn, one of the other two waits and the other one is refused.
  ASSERT_TRUE(WaitFor([&] { return others[0]->HasEnded() || others[1]->HasEnded(); }));
  ASSERT_TRUE(WaitFor([&] { return service.server().Load().waiting_pictures == 1; }));
  service.machine->drawing.Open();
  int refused = 0;
  for (const auto& other : others) {
    const grpc::Status status = other->End();
    if (status.error_code() != grpc::StatusCode::RESOURCE_EXHAUSTED) continue;
    ++refused;
    EXPECT_THAT(status.error_message(), HasSubstr("1 pictures wait to be drawn"));
  }
  EXPECT_EQ(refused, 1);
}

}  // namespace
}  // namespace thunderhead::testing
