// Tests of clients that request something and do not read the response.
#include <grpcpp/create_channel.h>

#include <chrono>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "access/access_control.h"
#include "access/audit.h"
#include "access/authenticator.h"
#include "gtest/gtest.h"
#include "store/sqlite_job_store.h"
#include "store/state_file.h"
#include "tests/service/fake_service.h"
#include "tests/service/untaking_client.h"
#include "tests/support/manual_time.h"
#include "tests/support/running_time.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"
#include "thunderhead/v1/job.grpc.pb.h"

namespace thunderhead::testing {
namespace {

// The time that a client has to read a response.
constexpr std::chrono::minutes kDelivery{2};

service::ServerOptions Deliver(const base::TimeSource& time) {
  service::ServerOptions options = Patient(time);
  options.address = "127.0.0.1:0";
  options.limits.delivery_time = kDelivery;
  return options;
}

// Waits until the server has begun to send its response, then lets the client's time to read it
// pass once, and waits until the server has reset the call. While the server prepares the response,
// the clock must not move, because other deadlines would pass as well.
bool AwaitReset(UntakingClient& client, RunningTime& time) {
  if (!WaitFor([&] { return client.IsAnswered(); })) return false;
  time.Advance(2 * kDelivery);
  return WaitFor([&] { return client.IsReset(); });
}

class PictureDelivery : public ::testing::TestWithParam<const char*> {
 protected:
  static std::string Asking() {
    v1::RenderImageRequest request;
    *request.mutable_scene() = SmallScene();
    request.set_in_chunks(true);
    return request.SerializeAsString();
  }
  static bool AwaitPictures(FakeService& fake, int pictures) {
    return WaitFor([&] { return fake.server().Load().pictures == pictures; });
  }
};

TEST_P(PictureDelivery, WhoTakesNothingIsCancelledAfterAWhile) {
  RunningTime time;
  FakeService fake(Deliver(time));
  UntakingClient client(fake.server().Port());
  client.Call(GetParam(), Asking());
  ASSERT_TRUE(AwaitPictures(fake, 1));
  // Drawing advances the same clock, so the test first waits until the picture is drawn.
  ASSERT_TRUE(WaitFor([&] { return fake.machine->Log().size() == 1; }));
  ASSERT_TRUE(WaitFor([&] { return fake.server().Load().turn_s == 0.0; }));
  EXPECT_TRUE(AwaitReset(client, time));
  EXPECT_TRUE(AwaitPictures(fake, 0)) << "the picture and its memory are given back";
}

TEST_P(PictureDelivery, ItHasItsTime) {
  ManualTime time;
  FakeService fake(Deliver(time));
  UntakingClient client(fake.server().Port());
  client.Call(GetParam(), Asking());
  ASSERT_TRUE(AwaitPictures(fake, 1));
  ASSERT_TRUE(WaitFor([&] { return fake.machine->Log().size() == 1; }));
  time.Advance(kDelivery - std::chrono::seconds(1));
  // The server checks deadlines several times during this period.
  v1::ListStormsResponse storms;
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(Call(fake.stub(), &v1::ThunderheadService::Stub::ListStorms,
                     v1::ListStormsRequest(), &storms)
                    .ok());
  }
  EXPECT_FALSE(client.IsReset());
  EXPECT_EQ(fake.server().Load().pictures, 1) << "it waits for its client";
}

INSTANTIATE_TEST_SUITE_P(
    Calls, PictureDelivery,
    ::testing::Values("thunderhead.v1.ThunderheadService/RenderImage",
                      "thunderhead.v1.ThunderheadService/RenderImageWithProgress"));

TEST(JobDelivery, WhoTakesNothingIsCancelledAfterAWhile) {
  const TemporaryFolder folder;
  RunningTime time;
  service::ServerOptions options = Deliver(time);
  auto file = store::StateFile::Open(folder.File("state.db"));
  ASSERT_TRUE(file.ok()) << file.status();
  options.jobs.store = *store::SqliteJobStore::In(*file);
  options.jobs.folder = folder.File("jobs");
  FakeService fake(options);
  const auto stub = v1::RenderJobService::NewStub(fake.server().LocalChannel());
  v1::CreateRenderJobRequest create;
  *create.add_pictures()->mutable_scene() = SmallScene();
  v1::CreateRenderJobResponse created;
  grpc::ClientContext creating;
  ASSERT_TRUE(stub->CreateRenderJob(&creating, create, &created).ok());
  v1::WatchRenderJobRequest watch;
  watch.set_job_id(created.job().id());
  grpc::ClientContext watching;
  const auto reader = stub->WatchRenderJob(&watching, watch);
  v1::WatchRenderJobResponse news;
  while (reader->Read(&news)) {
  }
  ASSERT_TRUE(reader->Finish().ok());

  UntakingClient watcher(fake.server().Port());
  watcher.Call("thunderhead.v1.RenderJobService/WatchRenderJob", watch.SerializeAsString());
  EXPECT_TRUE(AwaitReset(watcher, time));
  v1::FetchRenderResultRequest fetch;
  fetch.set_job_id(created.job().id());
  UntakingClient fetcher(fake.server().Port());
  fetcher.Call("thunderhead.v1.RenderJobService/FetchRenderResult", fetch.SerializeAsString());
  EXPECT_TRUE(AwaitReset(fetcher, time));
}

class ViewerDelivery : public ::testing::Test {
 protected:
  v1::CreateSessionResponse Create() {
    v1::CreateSessionRequest request;
    *request.mutable_scene() = SmallScene();
    v1::CreateSessionResponse response;
    EXPECT_TRUE(
        Call(fake_.stub(), &v1::ThunderheadService::Stub::CreateSession, request, &response).ok());
    return response;
  }
  bool AwaitViewers(int viewers) {
    return WaitFor([&] { return fake_.server().Load().viewers == viewers; });
  }

  RunningTime time_;
  FakeService fake_{Deliver(time_)};
};

TEST_F(ViewerDelivery, WhoTakesNoFramesIsCancelledAfterAWhile) {
  v1::WatchFramesRequest watch;
  watch.set_session_id(Create().viewer_key());
  UntakingClient viewer(fake_.server().Port());
  viewer.Call("thunderhead.v1.ThunderheadService/WatchFrames", watch.SerializeAsString());
  EXPECT_TRUE(AwaitViewers(1));
  EXPECT_TRUE(AwaitReset(viewer, time_));
  EXPECT_TRUE(AwaitViewers(0));
}

TEST_F(ViewerDelivery, WhoTakesNothingOfAnInteractIsCancelledAfterAWhile) {
  v1::InteractRequest join;
  join.mutable_join()->set_session_key(Create().viewer_key());
  UntakingClient viewer(fake_.server().Port());
  viewer.Call("thunderhead.v1.ThunderheadService/Interact", join.SerializeAsString(),
              UntakingClient::Stream::kStaysOpen);
  EXPECT_TRUE(AwaitReset(viewer, time_));
}

TEST_F(ViewerDelivery, WhoTakesFramesStaysForLongerThanOneHasTime) {
  const auto session = Create();
  Watcher viewer(fake_.stub(), session.viewer_key());
  ASSERT_TRUE(viewer.AwaitFrame(1, false));
  for (int i = 0; i < 10; ++i) {
    // The server writes the next frame only when the client has read this frame. No frame therefore
    // waits during two advances of the clock.
    time_.Advance(kDelivery / 2);
    v1::Scene scene = SmallScene();
    scene.mutable_sun()->set_azimuth_deg(static_cast<float>(i));
    ASSERT_TRUE(viewer.AwaitFrame(fake_.Update(session.session_id(), scene), false));
    EXPECT_EQ(fake_.server().Load().viewers, 1);
  }
}

class AnswerDelivery : public ::testing::TestWithParam<const char*> {};

TEST_P(AnswerDelivery, WhoTakesNothingIsCancelledAfterAWhile) {
  RunningTime time;
  FakeService fake(Deliver(time));
  UntakingClient client(fake.server().Port());
  v1::DescribeStormRequest request;
  request.set_storm_id("anvil");
  client.Call(std::string("thunderhead.v1.ThunderheadService/") + GetParam(),
              request.SerializeAsString());
  EXPECT_TRUE(AwaitReset(client, time));
}

// DescribeStorm runs on the executor between its request and its response, as maps and probes do.
INSTANTIATE_TEST_SUITE_P(Calls, AnswerDelivery, ::testing::Values("DescribeStorm", "ListStorms"));

TEST(AnswersDelivery, ThoseThatNobodyTakesHaveALimit) {
  service::ServerOptions options = Patient();
  options.address = "127.0.0.1:0";
  access::QuotaLimits limits;
  limits.max_streams_per_identity = 3;
  options.access_control = std::make_shared<access::AccessControl>(
      access::TrustEverybody(), std::make_shared<access::Audit>([](const std::string&) {}), limits);
  FakeService fake(options);
  UntakingClient client(fake.server().Port());
  for (int i = 0; i < 5; ++i) client.Call("thunderhead.v1.ThunderheadService/ListStorms", "");
  EXPECT_TRUE(WaitFor([&] { return client.Refused() >= 2; }));
  UntakingClient other(fake.server().Port());
  other.Call("thunderhead.v1.ThunderheadService/ListStorms", "");
  EXPECT_TRUE(WaitFor([&] { return other.Refused() >= 1; })) << "of one identity, however it calls";
  // Calls that the server has ended no longer count towards the limit.
  client.Leave();
  const auto stub = v1::ThunderheadService::NewStub(grpc::CreateChannel(
      absl::StrCat("127.0.0.1:", fake.server().Port()), grpc::InsecureChannelCredentials()));
  v1::ListStormsResponse storms;
  const auto lists = [&] {
    return Call(*stub, &v1::ThunderheadService::Stub::ListStorms, v1::ListStormsRequest(), &storms)
        .ok();
  };
  EXPECT_TRUE(WaitFor(lists));
}

TEST(AnswersDelivery, ThoseThatNobodyTakesAreLimitedInBytes) {
  const TemporaryFolder folder;
  service::ServerOptions options = Patient();
  options.address = "127.0.0.1:0";
  access::QuotaLimits limits;
  limits.max_unread_bytes_per_identity = 1;  // the first large answer reaches it
  options.access_control = std::make_shared<access::AccessControl>(
      access::TrustEverybody(), std::make_shared<access::Audit>([](const std::string&) {}), limits);
  auto file = store::StateFile::Open(folder.File("state.db"));
  ASSERT_TRUE(file.ok()) << file.status();
  options.jobs.store = *store::SqliteJobStore::In(*file);
  options.jobs.folder = folder.File("jobs");
  FakeService fake(options);
  // The description of a job of 1000 pictures exceeds the size that is always allowed.
  v1::CreateRenderJobRequest create;
  for (int i = 0; i < 1000; ++i) {
    auto& picture = *create.add_pictures();
    *picture.mutable_scene() = SmallScene();
    picture.mutable_scene()->set_storm_id("none");
    picture.set_name(absl::StrCat(std::string(100, 'n'), i));
  }
  const auto stub = v1::RenderJobService::NewStub(fake.server().LocalChannel());
  v1::CreateRenderJobResponse created;
  grpc::ClientContext creating;
  const grpc::Status status = stub->CreateRenderJob(&creating, create, &created);
  ASSERT_TRUE(status.ok()) << status.error_message();
  v1::GetRenderJobRequest get;
  get.set_job_id(created.job().id());
  v1::WatchRenderJobRequest watch;
  watch.set_job_id(created.job().id());
  UntakingClient client(fake.server().Port());
  client.Call("thunderhead.v1.RenderJobService/GetRenderJob", get.SerializeAsString());
  ASSERT_TRUE(WaitFor([&] { return client.IsAnswered(); }));
  EXPECT_EQ(client.Refused(), 0) << "one answer is always possible";
  client.Call("thunderhead.v1.RenderJobService/GetRenderJob", get.SerializeAsString());
  EXPECT_TRUE(WaitFor([&] { return client.Refused() == 1; }));
  client.Call("thunderhead.v1.RenderJobService/WatchRenderJob", watch.SerializeAsString());
  EXPECT_TRUE(WaitFor([&] { return client.Refused() == 2; })) << "streams share the memory";
}

}  // namespace
}  // namespace thunderhead::testing
