// Tests of the progress of single pictures, on a fake machine that traces a hundred thousand paths
// at a time.
#include <algorithm>
#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

#include "frame/image_codec.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/support/manual_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;
using Events = std::vector<v1::RenderImageEvent>;
using Stub = v1::ThunderheadService::Stub;
using std::chrono::milliseconds;

v1::RenderImageRequest RequestWith(v1::TracedLight traced_light) {
  v1::RenderImageRequest request;
  *request.mutable_scene() = SmallScene();
  v1::LightVolume& light_volume =
      *request.mutable_scene()->mutable_rendering()->mutable_light_volume();
  light_volume.set_transport(v1::TRANSPORT_DIFFUSION);
  light_volume.set_traced_light(traced_light);
  return request;
}

// A call that collects the events of a picture on its own thread.
class PictureCall {
 public:
  PictureCall(FakeService& service, const v1::RenderImageRequest& request)
      : thread_([this, &service, request] { Run(service, request); }) {}
  ~PictureCall() {
    context_.TryCancel();
    if (thread_.joinable()) thread_.join();
  }

  // Waits until there are at least `count` events, for at most kPatience.
  bool Await(std::size_t count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, [&] { return events_.size() >= count; });
  }
  void Cancel() { context_.TryCancel(); }
  grpc::Status End() {
    thread_.join();
    return end_;
  }
  // Returns all events. Call it only after the call has ended.
  const Events& AllEvents() const { return events_; }

 private:
  void Run(FakeService& service, const v1::RenderImageRequest& request) {
    const auto reader = service.stub().RenderImageWithProgress(&context_, request);
    v1::RenderImageEvent event;
    while (reader->Read(&event)) {
      {
        const std::lock_guard lock(mutex_);
        events_.push_back(event);
      }
      changed_.notify_all();
    }
    end_ = reader->Finish();
  }

  grpc::ClientContext context_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Events events_;
  grpc::Status end_;
  std::thread thread_;
};

// A fixture with a fake machine that traces a step only when the test lets it. The clock advances
// only when a test advances it.
class ImageProgressTest : public ::testing::Test {
 protected:
  ImageProgressTest() { service_.machine->tracing.Close(); }
  ~ImageProgressTest() override { service_.machine->tracing.Open(); }

  service::ServerOptions OneWaits() const {
    service::ServerOptions options = Patient(time_);
    options.render_loop.max_waiting_images = 1;
    return options;
  }

  void TraceStep(milliseconds takes) {
    ASSERT_TRUE(service_.machine->tracing.AwaitWaiting(1));
    time_.Advance(takes);
    service_.machine->tracing.LetOnePass();
  }

  ManualTime time_;
  FakeService service_{OneWaits()};
};

TEST_F(ImageProgressTest, ProgressRisesAndThePictureIsTheLastEvent) {
  PictureCall call(service_, RequestWith(v1::TRACED_LIGHT_AWAITED));
  TraceStep(milliseconds(50));
  ASSERT_TRUE(call.Await(1));
  for (int step = 0; step < 9; ++step) TraceStep(milliseconds(50));
  const grpc::Status end = call.End();
  ASSERT_TRUE(end.ok()) << end.error_message();
  const Events& events = call.AllEvents();
  // Later progress may be left out if the picture is finished before that progress is sent.
  ASSERT_GE(events.size(), 2U);
  const auto image = frame::DecodePng(events.back().image().image());
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_EQ(image->width_px, 64);
  EXPECT_EQ(events.back().image().modelled().traced_paths(), 1'000'000U);
  EXPECT_EQ(events.back().image().scene().storm_id(), "anvil");
  std::uint64_t paths = 0;
  for (std::size_t i = 0; i + 1 < events.size(); ++i) {
    const v1::RenderImageProgress& progress = events[i].progress();
    EXPECT_GE(progress.traced_paths(), i == 0 ? 100'000 : paths + 400'000)
        << "more than five times a second";
    paths = progress.traced_paths();
    EXPECT_FLOAT_EQ(progress.share(), 1e-6F * static_cast<float>(paths));
    EXPECT_GT(progress.estimated_error(), 0.0F);
  }
}

TEST_F(ImageProgressTest, ACancelledPictureIsTracedNoFurtherAndWaitsNoMore) {
  PictureCall call(service_, RequestWith(v1::TRACED_LIGHT_AWAITED));
  TraceStep(milliseconds(0));
  ASSERT_TRUE(call.Await(1));
  ASSERT_TRUE(service_.machine->tracing.AwaitWaiting(1)) << "the second step";
  call.Cancel();
  EXPECT_EQ(call.End().error_code(), grpc::StatusCode::CANCELLED);
  // The server notices the cancellation a moment later, during that step.
  ASSERT_TRUE(WaitFor([&] { return service_.server().Load().pictures == 0; }));
  service_.machine->tracing.Open();
  ASSERT_TRUE(WaitFor([&] { return service_.machine->traced_steps == 2; }));
  EXPECT_TRUE(service_.machine->Log().empty()) << "it was drawn";
  // The server draws only one picture at a time, and can now draw another.
  PictureCall next(service_, RequestWith(v1::TRACED_LIGHT_AWAITED));
  const grpc::Status end = next.End();
  EXPECT_TRUE(end.ok()) << end.error_message();
  EXPECT_TRUE(next.AllEvents().back().has_image());
  EXPECT_EQ(service_.machine->traced_steps, 10) << "a million paths in all, of which two steps";
}

TEST_F(ImageProgressTest, APictureThatDoesNotWaitIsItsOnlyEvent) {
  PictureCall call(service_, RequestWith(v1::TRACED_LIGHT_AT_REST));
  const grpc::Status end = call.End();
  ASSERT_TRUE(end.ok()) << end.error_message();
  ASSERT_EQ(call.AllEvents().size(), 1U);
  EXPECT_EQ(call.AllEvents()[0].image().modelled().traced_paths(), 0U);
  EXPECT_EQ(service_.machine->traced_steps, 0);
}

TEST_F(ImageProgressTest, ThePictureIsThatOfTheCallWithoutProgress) {
  const v1::RenderImageRequest request = RequestWith(v1::TRACED_LIGHT_OFF);
  PictureCall call(service_, request);
  ASSERT_TRUE(call.End().ok());
  v1::RenderImageResponse plain;
  ASSERT_TRUE(Call(service_.stub(), &Stub::RenderImage, request, &plain).ok());
  v1::RenderImageResponse told = call.AllEvents().back().image();
  EXPECT_EQ(told.image(), plain.image());
  EXPECT_EQ(told.stages_size(), plain.stages_size());
  // The two responses are the same except for the measured times.
  told.clear_stages();
  plain.clear_stages();
  told.clear_accuracy();
  plain.clear_accuracy();
  EXPECT_EQ(told.SerializeAsString(), plain.SerializeAsString());
}

TEST_F(ImageProgressTest, RefusalsAreThoseOfTheCallWithoutProgress) {
  const auto refusal = [&](const v1::RenderImageRequest& request) {
    PictureCall call(service_, request);
    const grpc::Status end = call.End();
    EXPECT_TRUE(call.AllEvents().empty());
    v1::RenderImageResponse response;
    const grpc::Status plain = Call(service_.stub(), &Stub::RenderImage, request, &response);
    EXPECT_EQ(end.error_code(), plain.error_code());
    EXPECT_EQ(end.error_message(), plain.error_message());
    return end.error_message();
  };
  v1::RenderImageRequest request = RequestWith(v1::TRACED_LIGHT_AWAITED);
  request.mutable_scene()->set_storm_id("hurricane");
  EXPECT_THAT(refusal(request), HasSubstr("hurricane"));
  request = RequestWith(v1::TRACED_LIGHT_AWAITED);
  service_.machine->cannot_trace_azimuth_deg = 123.0;
  request.mutable_scene()->mutable_sun()->set_azimuth_deg(123.0F);
  EXPECT_THAT(refusal(request), HasSubstr("cannot trace that"));
}

}  // namespace
}  // namespace thunderhead::testing
