// Clients that ask for something and do not take it.
#include <grpcpp/create_channel.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "absl/strings/str_cat.h"
#include "access/audit.h"
#include "access/authenticator.h"
#include "access/door.h"
#include "gtest/gtest.h"
#include "store/sqlite_job_store.h"
#include "store/state_file.h"
#include "tests/service/fake_service.h"
#include "tests/service/untaking_client.h"
#include "tests/support/temporary_folder.h"
#include "thunderhead/v1/job.grpc.pb.h"

namespace thunderhead::testing {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

class PictureDelivery : public ::testing::TestWithParam<const char*> {
 protected:
  static std::string Asking() {
    v1::RenderImageRequest request;
    *request.mutable_scene() = SmallScene();
    request.set_in_chunks(true);
    return request.SerializeAsString();
  }
  static bool AwaitPictures(FakeService& fake, int pictures, std::chrono::seconds patience) {
    const auto until = steady_clock::now() + patience;
    while (fake.server().Load().pictures != pictures && steady_clock::now() < until) {
      std::this_thread::sleep_for(milliseconds(5));
    }
    return fake.server().Load().pictures == pictures;
  }
};

TEST_P(PictureDelivery, WhoTakesNothingIsCancelledAfterAWhile) {
  service::ServerOptions options;
  options.address = "127.0.0.1:0";
  options.limits.delivery_time = milliseconds(500);
  FakeService fake(options);
  UntakingClient client(fake.server().Port());
  client.Call(GetParam(), Asking());
  ASSERT_TRUE(AwaitPictures(fake, 1, std::chrono::seconds(5)));
  EXPECT_TRUE(client.IsReset(milliseconds(10'000)));
  EXPECT_TRUE(AwaitPictures(fake, 0, std::chrono::seconds(5)))
      << "the picture and its memory are given back";
}

TEST_P(PictureDelivery, ItHasItsTime) {
  service::ServerOptions options;
  options.address = "127.0.0.1:0";
  FakeService fake(options);
  UntakingClient client(fake.server().Port());
  client.Call(GetParam(), Asking());
  EXPECT_FALSE(client.IsReset(milliseconds(1500)));
  EXPECT_EQ(fake.server().Load().pictures, 1) << "it waits for its client";
}

INSTANTIATE_TEST_SUITE_P(Calls, PictureDelivery,
                         ::testing::Values("ThunderheadService/RenderImage",
                                           "ThunderheadService/RenderImageWithProgress"));

TEST(JobDelivery, WhoTakesNothingIsCancelledAfterAWhile) {
  const TemporaryFolder folder;
  service::ServerOptions options;
  options.address = "127.0.0.1:0";
  options.limits.delivery_time = milliseconds(500);
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
  watcher.Call("RenderJobService/WatchRenderJob", watch.SerializeAsString());
  EXPECT_TRUE(watcher.IsReset(milliseconds(10'000)));
  v1::FetchRenderResultRequest fetch;
  fetch.set_job_id(created.job().id());
  UntakingClient fetcher(fake.server().Port());
  fetcher.Call("RenderJobService/FetchRenderResult", fetch.SerializeAsString());
  EXPECT_TRUE(fetcher.IsReset(milliseconds(10'000)));
}

class ViewerDelivery : public ::testing::Test {
 protected:
  ViewerDelivery() {
    options_.address = "127.0.0.1:0";
    options_.limits.delivery_time = milliseconds(500);
  }

  v1::CreateSessionResponse Create() {
    v1::CreateSessionRequest request;
    *request.mutable_scene() = SmallScene();
    v1::CreateSessionResponse response;
    EXPECT_TRUE(
        Call(fake_->stub(), &v1::ThunderheadService::Stub::CreateSession, request, &response).ok());
    return response;
  }
  bool AwaitViewers(int viewers) {
    for (int i = 0; i < 2000 && fake_->server().Load().viewers != viewers; ++i) {
      std::this_thread::sleep_for(milliseconds(5));
    }
    return fake_->server().Load().viewers == viewers;
  }

  service::ServerOptions options_;
  std::unique_ptr<FakeService> fake_;
};

TEST_F(ViewerDelivery, WhoTakesNoFramesIsCancelledAfterAWhile) {
  fake_ = std::make_unique<FakeService>(options_);
  v1::WatchFramesRequest watch;
  watch.set_session_id(Create().viewer_key());
  UntakingClient viewer(fake_->server().Port());
  viewer.Call("ThunderheadService/WatchFrames", watch.SerializeAsString());
  EXPECT_TRUE(AwaitViewers(1));
  EXPECT_TRUE(viewer.IsReset(milliseconds(10'000)));
  EXPECT_TRUE(AwaitViewers(0));
}

TEST_F(ViewerDelivery, WhoTakesNothingOfAnInteractIsCancelledAfterAWhile) {
  fake_ = std::make_unique<FakeService>(options_);
  v1::InteractRequest join;
  join.mutable_join()->set_session_key(Create().viewer_key());
  UntakingClient viewer(fake_->server().Port());
  viewer.Call("ThunderheadService/Interact", join.SerializeAsString(),
              UntakingClient::Stream::kStaysOpen);
  EXPECT_TRUE(viewer.IsReset(milliseconds(10'000)));
}

TEST_F(ViewerDelivery, WhoTakesFramesStaysForLongerThanOneHasTime) {
  options_.limits.delivery_time = milliseconds(100);
  fake_ = std::make_unique<FakeService>(options_);
  const auto session = Create();
  Watcher viewer(fake_->stub(), session.viewer_key());
  for (int i = 0; i < 20; ++i) {
    std::this_thread::sleep_for(milliseconds(50));
    EXPECT_EQ(fake_->server().Load().viewers, 1);
  }
}

class AnswerDelivery : public ::testing::TestWithParam<const char*> {};

TEST_P(AnswerDelivery, WhoTakesNothingIsCancelledAfterAWhile) {
  service::ServerOptions options;
  options.address = "127.0.0.1:0";
  options.limits.delivery_time = milliseconds(500);
  FakeService fake(options);
  UntakingClient client(fake.server().Port());
  v1::DescribeStormRequest request;
  request.set_storm_id("anvil");
  client.Call(std::string("ThunderheadService/") + GetParam(), request.SerializeAsString());
  EXPECT_TRUE(client.IsReset(milliseconds(10'000)));
}

// The first has an executor's turn between its request and its answer, as a map and a probe have.
INSTANTIATE_TEST_SUITE_P(Calls, AnswerDelivery, ::testing::Values("DescribeStorm", "ListStorms"));

TEST(AnswersDelivery, ThoseThatNobodyTakesHaveALimit) {
  service::ServerOptions options;
  options.address = "127.0.0.1:0";
  access::QuotaLimits limits;
  limits.max_streams_per_identity = 3;
  options.door = std::make_shared<access::Door>(
      access::TrustEverybody(), std::make_shared<access::Audit>([](const std::string&) {}), limits);
  FakeService fake(options);
  UntakingClient client(fake.server().Port());
  for (int i = 0; i < 5; ++i) client.Call("ThunderheadService/ListStorms", "");
  EXPECT_TRUE(client.AwaitRefused(2, std::chrono::seconds(10)));
  UntakingClient other(fake.server().Port());
  other.Call("ThunderheadService/ListStorms", "");
  EXPECT_TRUE(other.AwaitRefused(1, std::chrono::seconds(10)))
      << "of one identity, however it calls";
  // Those that are given up leave room.
  client.Leave();
  const auto stub = v1::ThunderheadService::NewStub(grpc::CreateChannel(
      absl::StrCat("127.0.0.1:", fake.server().Port()), grpc::InsecureChannelCredentials()));
  v1::ListStormsResponse storms;
  const auto lists = [&] {
    return Call(*stub, &v1::ThunderheadService::Stub::ListStorms, v1::ListStormsRequest(), &storms)
        .ok();
  };
  for (int i = 0; i < 1000 && !lists(); ++i) std::this_thread::sleep_for(milliseconds(5));
  EXPECT_TRUE(lists());
}

}  // namespace
}  // namespace thunderhead::testing
