// Tests of a server that shuts down: work in progress is delivered, new requests are refused, and
// viewers are notified.
#include <chrono>
#include <thread>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "telemetry/metrics.h"
#include "tests/service/fake_service.h"
#include "tests/service/interacting.h"
#include "tests/support/running_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using Response = v1::InteractResponse;
using Stub = v1::ThunderheadService::Stub;

class DrainTest : public ::testing::Test {
 protected:
  grpc::Status Render() {
    v1::RenderImageRequest request;
    *request.mutable_scene() = SmallScene();
    v1::RenderImageResponse response;
    return Call(service_.stub(), &Stub::RenderImage, request, &response);
  }

  grpc::Status CreateSession(std::string* key = nullptr) {
    v1::CreateSessionRequest request;
    *request.mutable_scene() = SmallScene();
    v1::CreateSessionResponse response;
    const grpc::Status status = Call(service_.stub(), &Stub::CreateSession, request, &response);
    if (key != nullptr) *key = response.session_id();
    return status;
  }

  // Waits until the server has `count` picture calls. gRPC releases a call some time after its
  // client has received the response.
  bool AwaitPictures(int count) {
    return WaitFor([&] { return service_.server().Load().pictures == count; });
  }

  bool AwaitNoTurn() {
    return WaitFor([&] { return service_.server().Load().turn_s == 0.0; });
  }

  static std::uint64_t Refusals(const char* reason) {
    return telemetry::Counted().refusals.Of(reason).Value();
  }

  RunningTime time_;
  FakeService service_{Patient(time_)};
};

TEST_F(DrainTest, DeliversThePictureThatWasBegunAndRefusesTheNext) {
  service_.machine->drawing.Close();
  grpc::Status begun;
  std::thread caller([&] { begun = Render(); });
  ASSERT_TRUE(service_.machine->drawing.AwaitWaiting(1));
  EXPECT_EQ(service_.server().Load().pictures, 1);
  const std::uint64_t refusals = Refusals("SHUTTING_DOWN");
  service_.server().BeginDrain();
  EXPECT_TRUE(service_.server().Load().draining);
  EXPECT_EQ(Render().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(CreateSession().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_GE(Refusals("SHUTTING_DOWN"), refusals + 2);
  EXPECT_TRUE(AwaitPictures(1)) << "of those that were refused none is left";
  service_.machine->drawing.Open();
  caller.join();
  EXPECT_TRUE(begun.ok()) << begun.error_message();
  EXPECT_TRUE(AwaitPictures(0));
}

TEST_F(DrainTest, TellsPeopleWhenToComeBack) {
  std::string key;
  ASSERT_TRUE(CreateSession(&key).ok());
  Interacting person(service_.stub(), key);
  person.AwaitNewest(Response::kFrame);
  EXPECT_EQ(service_.server().Load().viewers, 1);
  EXPECT_EQ(service_.server().Load().sessions, 1);
  service_.server().BeginDrain();
  const v1::End end = person.AwaitNewest(Response::kEnd).end();
  EXPECT_EQ(end.reason(), v1::End::REASON_SERVER_STOPS);
  EXPECT_GT(end.retry_after_ms(), 0U);
}

// Viewers who were notified may stay until the server ends, and can continue to work meanwhile.
TEST_F(DrainTest, SessionsGoOnForThoseWhoStay) {
  std::string key;
  ASSERT_TRUE(CreateSession(&key).ok());
  Interacting person(service_.stub(), key);
  Watcher program(service_.stub(), key);
  person.AwaitNewest(Response::kFrame);
  ASSERT_TRUE(program.AwaitFrame(1, false));
  service_.server().BeginDrain();
  person.AwaitNewest(Response::kEnd);
  v1::Scene scene = SmallScene();
  scene.mutable_sun()->set_azimuth_deg(77.0F);
  const std::uint64_t revision = service_.Update(key, scene);
  person.AwaitFrame(revision);
  EXPECT_TRUE(program.AwaitFrame(revision, false));
  EXPECT_EQ(service_.server().Load().viewers, 2);
  // No new viewer can join.
  Watcher late(service_.stub(), key);
  EXPECT_EQ(late.End().error_code(), grpc::StatusCode::UNAVAILABLE);
  service_.server().Shutdown();
  EXPECT_EQ(program.End().error_code(), grpc::StatusCode::UNAVAILABLE);
}

TEST_F(DrainTest, ATurnThatTakesLongIsSeen) {
  EXPECT_TRUE(AwaitNoTurn());
  service_.machine->drawing.Close();
  std::thread caller([&] { Render(); });
  ASSERT_TRUE(service_.machine->drawing.AwaitWaiting(1));
  time_.Advance(std::chrono::minutes(1));
  EXPECT_GE(service_.server().Load().turn_s, 60.0);
  service_.machine->drawing.Open();
  caller.join();
  EXPECT_TRUE(AwaitNoTurn()) << "nothing is to be done";
}

TEST_F(DrainTest, AWorkerThatMakesNoProgressIsSeen) {
  EXPECT_EQ(service_.server().Load().stalled_s, 0.0);
  service_.store->reading.Close();
  std::thread caller([&] { Render(); });
  ASSERT_TRUE(service_.store->reading.AwaitWaiting(1));
  time_.Advance(std::chrono::minutes(1));
  EXPECT_GE(service_.server().Load().stalled_s, 60.0);
  EXPECT_TRUE(AwaitNoTurn()) << "it is no turn of drawing";
  service_.store->reading.Open();
  caller.join();
  EXPECT_TRUE(WaitFor([&] { return service_.server().Load().stalled_s == 0.0; }))
      << "nothing is to be done";
}

TEST_F(DrainTest, FramesAndTheirLatencyAreCounted) {
  telemetry::Metrics& counted = telemetry::Counted();
  const auto latencies = [&counted] {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i <= telemetry::Histogram::kBounds; ++i) {
      count += counted.update_to_frame.Count(i);
    }
    return count;
  };
  std::string key;
  ASSERT_TRUE(CreateSession(&key).ok());
  Interacting person(service_.stub(), key);
  person.AwaitNewest(Response::kFrame);
  const std::uint64_t latencies_before = latencies();
  const std::uint64_t bytes_before = counted.frame_bytes_sent.Value();
  const std::uint64_t sent_before = counted.frames_sent.Value();
  v1::Scene scene = SmallScene();
  scene.mutable_sun()->set_azimuth_deg(123.0F);
  person.AwaitFrame(service_.Update(key, scene));
  EXPECT_TRUE(WaitFor([&] { return latencies() > latencies_before; }));
  EXPECT_EQ(latencies(), latencies_before + 1) << "the first frame of a revision";
  EXPECT_GT(counted.frames_sent.Value(), sent_before);
  EXPECT_GT(counted.frame_bytes_sent.Value(), bytes_before + 100);
}

}  // namespace
}  // namespace thunderhead::testing
