// Single pictures beside sessions: that they hold nobody up, wait instead of being refused, and end
// when nobody wants them. On a fake machine that draws in pieces.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "service/status_table.h"
#include "tests/service/fake_service.h"

namespace thunderhead::testing {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using ::testing::HasSubstr;

double MillisecondsSince(steady_clock::time_point begun) {
  return std::chrono::duration<double, std::milli>(steady_clock::now() - begun).count();
}

v1::RenderImageRequest Still(std::uint32_t width_px, std::uint32_t height_px, std::uint32_t slices,
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

// One that takes 3 s if a million samples take 200 ms.
v1::RenderImageRequest LongStill() { return Still(640, 360, 64); }

// Calls without threads.
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

bool ComesTrue(const std::function<bool()>& holds) {
  const auto until = steady_clock::now() + kPatience;
  while (!holds() && steady_clock::now() < until) std::this_thread::sleep_for(milliseconds(2));
  return holds();
}

TEST(StillsTest, ALongOneHoldsUpNoSession) {
  FakeService service;
  service.machine->ms_per_mega_sample = 200.0;
  const std::string id = service.Open(SmallScene());
  Watcher watcher(service.stub(), id);
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  Asked still(service, LongStill());
  ASSERT_TRUE(ComesTrue([&] { return service.machine->pieces > 3; }));
  std::vector<double> latencies_ms;
  for (int i = 0; i < 20; ++i) {
    v1::Scene scene = SmallScene();
    scene.mutable_camera()->mutable_orbit()->set_azimuth_deg(static_cast<float>(10 + i));
    const auto updated = steady_clock::now();
    ASSERT_TRUE(watcher.AwaitFrame(service.Update(id, scene), false));
    latencies_ms.push_back(MillisecondsSince(updated));
  }
  EXPECT_FALSE(still.HasEnded()) << "too fast to tell";
  std::ranges::sort(latencies_ms);
  // A frame of some 7 ms and half a piece of 10; much, because tests share processors.
  EXPECT_LT(latencies_ms[latencies_ms.size() / 2], 60.0);
  EXPECT_LT(latencies_ms.back(), 500.0);
  const grpc::Status end = still.End();
  EXPECT_TRUE(end.ok()) << end.error_message();
}

TEST(StillsTest, OneThatNobodyWantsIsDrawnNoFurther) {
  FakeService service;
  service.machine->ms_per_mega_sample = 200.0;
  Asked still(service, LongStill());
  ASSERT_TRUE(ComesTrue([&] { return service.machine->pieces > 3; }));
  still.Cancel();
  EXPECT_EQ(still.End().error_code(), grpc::StatusCode::CANCELLED);
  std::this_thread::sleep_for(milliseconds(200));
  const int pieces = service.machine->pieces;
  EXPECT_LT(pieces, 60) << "of 300";
  std::this_thread::sleep_for(milliseconds(100));
  EXPECT_EQ(service.machine->pieces, pieces);
  Asked next(service, Still(64, 36, 16));
  EXPECT_TRUE(next.End().ok());
}

TEST(StillsTest, OneThatWouldTakeTooLongIsRefusedAtOnceByName) {
  service::ServerOptions options;
  options.render_loop.image_limits.max_predicted_s = 10.0;
  FakeService service(options);
  service.machine->drawing.Close();
  Asked drawn(service, Still(64, 36, 16));
  Asked huge(service, Still(8192, 4096, 4096));
  // Not held up by what is drawn, but for its piece.
  ASSERT_TRUE(service.machine->drawing.AwaitWaiting(1));
  service.machine->drawing.Open();
  const grpc::Status refused = huge.End();
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(refused.error_message(),
              HasSubstr("scene.output asks for a picture that would take"));
  EXPECT_THAT(refused.error_message(), HasSubstr("at most 10 s: ask for fewer pixels"));
  EXPECT_TRUE(drawn.End().ok());
  EXPECT_EQ(service.store->Reads(), 1) << "it was read";
}

TEST(StillsTest, OneThatTakesLongerThanPredictedEnds) {
  service::ServerOptions options;
  options.render_loop.image_limits.max_predicted_s = 0.1;
  FakeService service(options);
  service.machine->ms_per_mega_sample = 200.0;  // believed to be 2 at first
  const auto begun = steady_clock::now();
  Asked still(service, LongStill());
  const grpc::Status end = still.End();
  EXPECT_EQ(end.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << end.error_message();
  EXPECT_THAT(end.error_message(), HasSubstr("drawing took more than"));
  EXPECT_LT(MillisecondsSince(begun), 2000.0) << "of 3000";
}

TEST(StillsTest, HundredsAtOnceWaitAndAllAreDrawn) {
  FakeService service;
  std::deque<Asked> stills;
  for (std::uint32_t i = 0; i < 400; ++i) stills.emplace_back(service, Still(64, 36, 16, i % 4));
  for (Asked& still : stills) {
    const grpc::Status end = still.End();
    ASSERT_TRUE(end.ok()) << end.error_message();
  }
}

TEST(StillsTest, ThoseThatWaitHoldNoFields) {
  FakeService service;
  service.machine->drawing.Close();
  std::deque<Asked> stills;
  stills.emplace_back(service, Still(64, 36, 16, 0));
  ASSERT_TRUE(service.machine->drawing.AwaitWaiting(1));
  for (std::uint32_t time = 1; time < 4; ++time)
    stills.emplace_back(service, Still(64, 36, 16, time));
  std::this_thread::sleep_for(milliseconds(200));
  EXPECT_LE(service.store->Reads(), 2) << "one is drawn, one may be read meanwhile";
  service.machine->drawing.Open();
  for (Asked& still : stills) EXPECT_TRUE(still.End().ok());
}

TEST(StillsTest, QuickOnesPassThoseThatTakeLong) {
  FakeService service;
  service.machine->ms_per_mega_sample = 0.2;
  // Believed to take 17 s each; they take 2.
  Asked first(service, Still(8192, 1024, 1024));
  Asked second(service, Still(8192, 1024, 1024));
  ASSERT_TRUE(ComesTrue([&] { return service.machine->pieces > 3; }));
  for (int i = 0; i < 5; ++i) {
    Asked quick(service, Still(64, 36, 16));
    EXPECT_TRUE(quick.End().ok());
  }
  EXPECT_FALSE(first.HasEnded());
  EXPECT_FALSE(second.HasEnded());
  first.Cancel();
  second.Cancel();
}

}  // namespace
}  // namespace thunderhead::testing
