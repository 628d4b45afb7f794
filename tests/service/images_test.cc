// Tests of single pictures next to sessions, on a fake machine that draws in pieces. Single
// pictures must not delay sessions, must wait instead of being refused, and must end when no caller
// wants them.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/support/figure.h"
#include "tests/support/manual_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using std::chrono::steady_clock;
using ::testing::HasSubstr;

v1::RenderImageRequest Image(std::uint32_t width_px, std::uint32_t height_px, std::uint32_t slices,
                             std::uint32_t time_index = 0) {
  v1::RenderImageRequest request;
  v1::Scene& scene = *request.mutable_scene();
  scene = SmallScene();
  scene.set_time_index(time_index);
  scene.mutable_output()->set_width_px(width_px);
  scene.mutable_output()->set_height_px(height_px);
  scene.mutable_rendering()->mutable_light_volume()->set_slices(slices);
  return request;
}

// Returns a picture that takes 3 s, in 300 pieces, if a million samples take 200 ms.
v1::RenderImageRequest LongImage() { return Image(640, 360, 64); }

// Returns a picture that takes half an hour at that speed. It does not end while a test runs.
v1::RenderImageRequest EndlessImage() { return Image(8192, 1024, 1024); }

v1::Scene SeenFrom(double azimuth_deg) {
  v1::Scene scene = SmallScene();
  scene.mutable_camera()->mutable_orbit()->set_azimuth_deg(static_cast<float>(azimuth_deg));
  return scene;
}

// An asynchronous call, for which the test needs no thread.
class Asked {
 public:
  Asked(FakeService& service, const v1::RenderImageRequest& request) : request_(request) {
    service.stub().async()->RenderImage(&context_, &request_, &response_,
                                        [this](const grpc::Status& status) {
                                          const std::lock_guard lock(mutex_);
                                          status_ = status;
                                          ended_ = true;
                                          changed_.notify_all();
                                        });
  }
  ~Asked() { End(); }
  Asked(const Asked&) = delete;
  Asked& operator=(const Asked&) = delete;

  void Cancel() { context_.TryCancel(); }
  bool HasEnded() {
    const std::lock_guard lock(mutex_);
    return ended_;
  }
  grpc::Status End() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return ended_; });
    return status_;
  }

 private:
  grpc::ClientContext context_;
  const v1::RenderImageRequest request_;
  v1::RenderImageResponse response_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;
  grpc::Status status_;
};

TEST(ImagesTest, ALongOneHoldsUpNoSession) {
  ManualTime time;
  service::ServerOptions options = Patient(time);
  FakeService service(options);
  service.machine->time = &time;
  service.machine->ms_per_mega_sample = 200.0;
  const std::string id = service.Open(SmallScene());
  Watcher watcher(service.stub(), id);
  ASSERT_TRUE(watcher.AwaitFrame(1, false));
  service.machine->next_piece.Close();
  service.machine->next_piece.LetPass(4);
  Asked image(service, LongImage());
  ASSERT_TRUE(service.machine->next_piece.AwaitWaiting(1));
  for (int i = 0; i < 20; ++i) {
    const double azimuth_deg = 10.0 + i;
    const std::uint64_t revision = service.Update(id, SeenFrom(azimuth_deg));
    const int pieces = service.machine->PiecesUntil([&](const FakeMachine::Drawn& drawn) {
      const auto* const orbit = std::get_if<scene::OrbitCamera>(&drawn.scene.camera);
      return orbit != nullptr && orbit->azimuth_deg == azimuth_deg;
    });
    ASSERT_GE(pieces, 0);
    EXPECT_LE(pieces, 2) << "of 300, before a moving frame";
    ASSERT_TRUE(watcher.AwaitFrame(revision, false));
  }
  EXPECT_FALSE(image.HasEnded());
  service.machine->next_piece.Open();
  const grpc::Status end = image.End();
  EXPECT_TRUE(end.ok()) << end.error_message();
}

TEST(ImagesBenchmark, MovingFramesBesideALongImage) {
  FakeService service;
  service.machine->ms_per_mega_sample = 200.0;  // 7 ms for each frame, pieces of 10 ms
  const std::string id = service.Open(SmallScene());
  Watcher watcher(service.stub(), id);
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  Asked image(service, EndlessImage());
  ASSERT_TRUE(WaitFor([&] { return service.machine->pieces > 3; }));
  std::vector<double> latencies_ms;
  for (int i = 0; i < 50; ++i) {
    const auto updated = steady_clock::now();
    ASSERT_TRUE(watcher.AwaitFrame(service.Update(id, SeenFrom(10 + i)), false));
    latencies_ms.push_back(
        std::chrono::duration<double, std::milli>(steady_clock::now() - updated).count());
  }
  std::ranges::sort(latencies_ms);
  Figure("moving frame beside a long image, median", latencies_ms[latencies_ms.size() / 2], "ms");
  Figure("moving frame beside a long image, longest", latencies_ms.back(), "ms");
  image.Cancel();
}

TEST(ImagesTest, OneThatNobodyWantsIsDrawnNoFurther) {
  FakeService service;
  service.machine->ms_per_mega_sample = 200.0;
  Asked image(service, EndlessImage());
  ASSERT_TRUE(WaitFor([&] { return service.machine->pieces > 3; }));
  image.Cancel();
  EXPECT_EQ(image.End().error_code(), grpc::StatusCode::CANCELLED);
  ASSERT_TRUE(WaitFor([&] { return service.server().Load().pictures == 0; }));
  const int pieces = service.machine->pieces;
  Asked next(service, Image(64, 36, 16));
  EXPECT_TRUE(next.End().ok());
  EXPECT_EQ(service.machine->pieces, pieces + 1) << "the next has one";
}

TEST(ImagesTest, OneThatWouldTakeTooLongIsRefusedAtOnceByName) {
  service::ServerOptions options = Patient();
  options.render_loop.image_limits.max_predicted_s = 10.0;
  FakeService service(options);
  service.machine->drawing.Close();
  Asked drawn(service, Image(64, 36, 16));
  Asked huge(service, Image(8192, 4096, 4096));
  // A small picture is delayed only by the current piece of the picture being drawn.
  ASSERT_TRUE(service.machine->drawing.AwaitWaiting(1));
  service.machine->drawing.Open();
  const grpc::Status refused = huge.End();
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(refused.error_message(),
              HasSubstr("scene.output asks for a picture that would take"));
  EXPECT_THAT(refused.error_message(),
              HasSubstr("limit for one picture is 10 s: ask for fewer pixels"));
  EXPECT_TRUE(drawn.End().ok());
  EXPECT_EQ(service.store->Reads(), 1) << "it was read";
}

TEST(ImagesTest, OneThatTakesLongerThanPredictedEnds) {
  ManualTime time;
  service::ServerOptions options = Patient(time);
  options.render_loop.image_limits.max_predicted_s = 0.1;
  FakeService service(options);
  service.machine->time = &time;
  // Milliseconds per million samples; before its first frame the server assumes 2 ms.
  service.machine->ms_per_mega_sample = 200.0;
  Asked image(service, LongImage());
  const grpc::Status end = image.End();
  EXPECT_EQ(end.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << end.error_message();
  EXPECT_THAT(end.error_message(), HasSubstr("drawing took more than"));
  EXPECT_LE(service.machine->pieces, 21) << "of 300: twice the limit";
}

TEST(ImagesTest, HundredsAtOnceWaitAndAllAreDrawn) {
  FakeService service;
  std::deque<Asked> images;
  for (std::uint32_t i = 0; i < 400; ++i) images.emplace_back(service, Image(64, 36, 16, i % 4));
  for (Asked& image : images) {
    const grpc::Status end = image.End();
    ASSERT_TRUE(end.ok()) << end.error_message();
  }
}

TEST(ImagesTest, ThoseThatWaitHoldNoFields) {
  FakeService service;
  service.machine->ms_per_mega_sample = 0.01;
  // The server expects each picture to take 9 s, so all of them wait for the same worker (drawing
  // thread). In fact they take 43 ms.
  const auto long_image = [](std::uint32_t time) { return Image(1024, 1024, 4096, time); };
  service.machine->next_piece.Close();
  std::deque<Asked> images;
  images.emplace_back(service, long_image(0));
  ASSERT_TRUE(service.machine->next_piece.AwaitWaiting(1));
  for (std::uint32_t time = 1; time < 4; ++time) images.emplace_back(service, long_image(time));
  ASSERT_TRUE(WaitFor([&] { return service.server().Load().waiting_pictures == 3; }));
  // The render loop handles the new requests between two pieces.
  service.machine->next_piece.LetPass(3);
  ASSERT_TRUE(service.machine->next_piece.AwaitWaiting(1));
  EXPECT_EQ(service.store->Reads(), 1);
  service.machine->next_piece.Open();
  for (Asked& image : images) EXPECT_TRUE(image.End().ok());
}

TEST(ImagesTest, QuickOnesPassThoseThatTakeLong) {
  FakeService service;
  service.machine->ms_per_mega_sample = 200.0;
  Asked first(service, EndlessImage());
  Asked second(service, EndlessImage());
  ASSERT_TRUE(WaitFor([&] { return service.machine->pieces > 3; }));
  for (int i = 0; i < 5; ++i) {
    Asked quick(service, Image(64, 36, 16));
    EXPECT_TRUE(quick.End().ok());
  }
  EXPECT_FALSE(first.HasEnded());
  EXPECT_FALSE(second.HasEnded());
  first.Cancel();
  second.Cancel();
}

}  // namespace
}  // namespace thunderhead::testing
