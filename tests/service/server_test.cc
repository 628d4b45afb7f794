// Tests of the server as a whole: ports, health, shutdown.
#include "service/server.h"

#include <grpcpp/generic/generic_stub.h>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;
using Stub = v1::ThunderheadService::Stub;

grpc::ByteBuffer Bytes(const std::string& bytes) {
  const grpc::Slice slice(bytes);
  return {&slice, 1};
}

std::string Text(grpc::ByteBuffer& buffer) {
  std::vector<grpc::Slice> slices;
  EXPECT_TRUE(buffer.Dump(&slices).ok());
  std::string text;
  for (const grpc::Slice& slice : slices) {
    text.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  }
  return text;
}

// Sends one message to a service whose generated code Debian does not ship, and returns the first
// reply.
std::string Ask(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
                const std::string& request) {
  grpc::GenericStub stub(channel);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
  grpc::CompletionQueue queue;
  const auto await = [&] {
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  const auto call = stub.PrepareCall(&context, method, &queue);
  grpc::ByteBuffer reply;
  call->StartCall(nullptr);
  EXPECT_TRUE(await());
  call->Write(Bytes(request), nullptr);
  EXPECT_TRUE(await());
  call->WritesDone(nullptr);
  EXPECT_TRUE(await());
  call->Read(&reply, nullptr);
  EXPECT_TRUE(await());
  grpc::Status status;
  call->Finish(&status, nullptr);
  EXPECT_TRUE(await());
  EXPECT_TRUE(status.ok()) << status.error_message();
  queue.Shutdown();
  return Text(reply);
}

TEST(ServerTest, HealthIsServingInProcessAndOnItsPort) {
  service::ServerOptions options = Patient();
  options.address = "127.0.0.1:0";
  FakeService service(options);
  ASSERT_GT(service.server().Port(), 0);
  const auto remote = grpc::CreateChannel("127.0.0.1:" + std::to_string(service.server().Port()),
                                          grpc::InsecureChannelCredentials());
  // In HealthCheckResponse, field 1 (status) is 1, SERVING. One request is for all services, one
  // for ours by name (field 1).
  const std::string serving("\x08\x01", 2);
  const std::string name = "thunderhead.v1.ThunderheadService";
  const std::string by_name = std::string("\x0a") + static_cast<char>(name.size()) + name;
  for (const auto& channel : {service.server().LocalChannel(), remote}) {
    EXPECT_EQ(Ask(channel, "/grpc.health.v1.Health/Check", ""), serving);
    EXPECT_EQ(Ask(channel, "/grpc.health.v1.Health/Check", by_name), serving);
  }
  const std::string not_serving("\x08\x02", 2);
  const auto health = [&] { return Ask(remote, "/grpc.health.v1.Health/Check", by_name); };
  service.server().SetServing(false);
  EXPECT_EQ(health(), not_serving);
  service.server().SetServing(true);
  EXPECT_EQ(health(), serving);
  service.server().BeginDrain();
  service.server().SetServing(true);
  EXPECT_EQ(health(), not_serving) << "it drains";
}

TEST(ServerTest, TakenPortIsAnError) {
  service::ServerOptions options = Patient();
  options.address = "127.0.0.1:0";
  FakeService first(options);
  options.address = "127.0.0.1:" + std::to_string(first.server().Port());
  const auto second = service::Server::Start(options, std::make_shared<FakeStormStore>(),
                                             FakeFrameSources(std::make_shared<FakeMachine>()));
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(std::string(second.status().message()),
              HasSubstr("cannot listen for gRPC on " + options.address));
}

TEST(ServerTest, FrameSourceThatCannotBeMadeIsAnError) {
  const auto server = service::Server::Start(
      {}, std::make_shared<FakeStormStore>(),
      [](base::DeviceTurn*) -> absl::StatusOr<std::unique_ptr<drawing::FrameSource>> {
        return absl::NotFoundError("there is no GPU 3");
      });
  ASSERT_FALSE(server.ok());
  EXPECT_EQ(server.status().message(), "there is no GPU 3");
}

TEST(ServerTest, ShutdownEndsStreamsAndPicturesWithUnavailable) {
  FakeService service;
  Watcher watcher(service.stub(), service.Open(SmallScene()));
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  service.machine->drawing.Close();
  grpc::Status drawn;
  grpc::Status waited;
  const auto render = [&](std::uint32_t time_index, grpc::Status* status) {
    v1::RenderImageRequest request;
    *request.mutable_scene() = SmallScene();
    request.mutable_scene()->set_time_index(time_index);
    v1::RenderImageResponse response;
    *status = Call(service.stub(), &Stub::RenderImage, request, &response);
  };
  std::thread first([&] { render(1, &drawn); });
  ASSERT_TRUE(service.machine->drawing.AwaitWaiting(1));
  std::thread second([&] { render(2, &waited); });
  EXPECT_TRUE(WaitFor([&] { return service.server().Load().pictures == 2; }));
  // The storm is read when its picture is begun.
  EXPECT_TRUE(WaitFor([&] { return service.server().Load().waiting_pictures == 1; }));
  std::thread shutdown([&] { service.server().Shutdown(); });
  const grpc::Status ended = watcher.End();
  service.machine->drawing.Open();
  shutdown.join();
  first.join();
  second.join();
  EXPECT_EQ(ended.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(ended.error_message(), "the server is shutting down");
  EXPECT_EQ(waited.error_code(), grpc::StatusCode::UNAVAILABLE);
  // The picture being drawn is delivered if its encoding began in time.
  EXPECT_TRUE(drawn.ok() || drawn.error_code() == grpc::StatusCode::UNAVAILABLE)
      << drawn.error_message();
}

TEST(ServerTest, ShutdownWithManyBusyStreamsEnds) {
  FakeService service;
  std::vector<std::string> sessions;
  std::vector<std::unique_ptr<Watcher>> watchers;
  for (int i = 0; i < 8; ++i) {
    sessions.push_back(service.Open(SmallScene()));
    watchers.push_back(std::make_unique<Watcher>(service.stub(), sessions.back()));
    watchers.push_back(std::make_unique<Watcher>(service.stub(), sessions.back(), i % 2 == 0));
  }
  for (int round = 0; round < 20; ++round) {
    for (const std::string& session : sessions) {
      v1::Scene scene = SmallScene();
      scene.mutable_sun()->set_azimuth_deg(static_cast<float>(round));
      service.Update(session, scene);
    }
  }
  service.server().Shutdown();
  for (const auto& watcher : watchers) {
    EXPECT_EQ(watcher->End().error_code(), grpc::StatusCode::UNAVAILABLE);
  }
}

TEST(ServerTest, UnreadStormHoldsUpNoShutdownForever) {
  auto service = std::make_unique<FakeService>();
  service->store->reading.Close();
  std::thread reader([&] {
    v1::DescribeStormResponse response;
    Call(service->stub(), &Stub::DescribeStorm, v1::DescribeStormRequest(), &response);
  });
  ASSERT_TRUE(service->store->reading.AwaitWaiting(1));
  std::thread shutdown([&] { service->server().Shutdown(); });
  service->store->reading.Open();
  shutdown.join();
  reader.join();
}

}  // namespace
}  // namespace thunderhead::testing
