// Tests of runs at a server that is broken or hostile.
#include "runs/job_run.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "grpcpp/server.h"
#include "grpcpp/server_builder.h"
#include "gtest/gtest.h"
#include "pipeline/sha256.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::runs {
namespace {

using ::testing::HasSubstr;
using PictureState = v1::RenderJobPictureState;

// A server whose answers a test chooses. It has one storm and one job.
class FakeServer : public v1::ThunderheadService::Service, public v1::RenderJobService::Service {
 public:
  using Fetched = grpc::ServerWriter<v1::FetchRenderResultResponse>;

  FakeServer() {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(static_cast<v1::ThunderheadService::Service*>(this));
    builder.RegisterService(static_cast<v1::RenderJobService::Service*>(this));
    server_ = builder.BuildAndStart();
    storm.set_id("storm");
    v1::StormTime& time = *storm.add_times();
    time.set_valid_time("2013-05-20T20:00:00Z");
    time.mutable_file()->set_name("storm.nc");
    picture.set_state(PictureState::STATE_DRAWN);
    picture.set_sha256(pipeline::Sha256("the picture"));
    send = [](Fetched& to) { to.Write(Part("the picture", 11)); };
  }
  ~FakeServer() override { server_->Shutdown(std::chrono::system_clock::now()); }
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;

  static v1::FetchRenderResultResponse Part(const std::string& chunk, std::uint64_t total) {
    v1::FetchRenderResultResponse part;
    part.mutable_picture();
    part.mutable_input()->mutable_file()->set_name("storm.nc");
    part.set_total_bytes(total);
    part.set_chunk(chunk);
    return part;
  }

  std::string Address() const { return absl::StrCat("127.0.0.1:", port_); }

  grpc::Status DescribeStorm(grpc::ServerContext*, const v1::DescribeStormRequest*,
                             v1::DescribeStormResponse* response) override {
    *response->mutable_storm() = storm;
    return grpc::Status::OK;
  }
  grpc::Status ListRenderJobs(grpc::ServerContext*, const v1::ListRenderJobsRequest*,
                              v1::ListRenderJobsResponse* response) override {
    for (int i = 0; i < listed_jobs; ++i) response->add_jobs()->set_id(absl::StrCat("old", i));
    return grpc::Status::OK;
  }
  grpc::Status GetRenderJob(grpc::ServerContext*, const v1::GetRenderJobRequest*,
                            v1::GetRenderJobResponse*) override {
    ++asked_jobs;
    return grpc::Status::OK;
  }
  grpc::Status CancelRenderJob(grpc::ServerContext*, const v1::CancelRenderJobRequest*,
                               v1::CancelRenderJobResponse*) override {
    return grpc::Status::OK;
  }
  grpc::Status CreateRenderJob(grpc::ServerContext*, const v1::CreateRenderJobRequest*,
                               v1::CreateRenderJobResponse* response) override {
    response->mutable_job()->set_id("job");
    return grpc::Status::OK;
  }
  grpc::Status WatchRenderJob(grpc::ServerContext* context, const v1::WatchRenderJobRequest*,
                              grpc::ServerWriter<v1::WatchRenderJobResponse>* to) override {
    ++watches;
    // In the first stream, empty messages come for as long as the client reads them.
    while (empty_news && watches == 1 && !context->IsCancelled()) to->Write({});
    v1::WatchRenderJobResponse news;
    news.mutable_job();
    *news.add_pictures() = picture;
    to->Write(news);
    return grpc::Status::OK;
  }
  grpc::Status FetchRenderResult(grpc::ServerContext*, const v1::FetchRenderResultRequest*,
                                 Fetched* to) override {
    ++fetches;
    send(*to);
    return grpc::Status::OK;
  }

  v1::StormDescription storm;
  PictureState picture;
  std::function<void(Fetched&)> send;
  bool empty_news = false;
  int listed_jobs = 0;
  std::atomic<int> asked_jobs = 0;
  std::atomic<int> watches = 0;
  std::atomic<int> fetches = 0;

 private:
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

class JobRunTest : public ::testing::Test {
 protected:
  // Makes the picture, and returns the error of the run or the outcome of the picture.
  absl::Status Make() {
    ServerLink link({.address = server_.Address(), .token = "", .tls_roots = ""});
    const auto storm = DescribeStorm(link, "storm");
    if (!storm.ok()) return storm.status();
    PictureRunOptions options{.product = *pipeline::ProductName::Parse("--product", product_),
                              .format = {.kind = ProductKind::kExr}};
    options.views.emplace_back().name = "view";
    options.manifest = folder_.File("manifest.jsonl");
    auto pictures = PlanOfServer(options, link, *storm, 0, {0}, true);
    if (!pictures.ok()) return pictures.status();
    const auto run = PictureRun::Open(std::move(options));
    if (!run.ok()) return run.status();
    RunProgress progress(ProgressStyle::kNone, "test");
    const absl::Status made = MakeByJobs(link, **run, *pictures, progress, {});
    return made.ok() ? pictures->front().outcome : made;
  }

  bool IsMade() const { return std::filesystem::exists(product_); }

  const testing::TemporaryFolder folder_;
  const std::string product_ = folder_.File("picture.exr");
  FakeServer server_;
};

TEST_F(JobRunTest, MakesAPicture) {
  EXPECT_EQ(Make(), absl::OkStatus());
  EXPECT_TRUE(IsMade());
}

TEST_F(JobRunTest, TheStormIsTheOneThatWasAskedFor) {
  server_.storm.set_id("../\nother");
  const absl::Status made = Make();
  EXPECT_EQ(made.code(), absl::StatusCode::kInternal);
  EXPECT_THAT(std::string(made.message()), HasSubstr("'storm' is of another one, '../?other'"));
}

TEST_F(JobRunTest, AStormHasTimes) {
  server_.storm.clear_times();
  const absl::Status made = Make();
  EXPECT_EQ(made.code(), absl::StatusCode::kInternal);
  EXPECT_THAT(std::string(made.message()), HasSubstr("has no times"));
}

TEST_F(JobRunTest, LeadTimesAreFiniteAndBounded) {
  for (const double lead_s : {1.1e9, -1e300, std::nan(""), std::numeric_limits<double>::max()}) {
    server_.storm.mutable_times(0)->set_lead_s(lead_s);
    EXPECT_EQ(Make().code(), absl::StatusCode::kInternal) << lead_s;
  }
  server_.storm.mutable_times(0)->set_lead_s(-1e9);
  EXPECT_EQ(Make(), absl::OkStatus());
}

TEST_F(JobRunTest, APictureThatFailedIsNeverMade) {
  for (const auto state : {PictureState::STATE_FAILED, PictureState::STATE_DROPPED}) {
    server_.picture.set_state(state);
    for (const int code : {0, 99, -1}) {
      server_.picture.mutable_problem()->set_code(code);
      const absl::Status made = Make();
      EXPECT_EQ(made.code(), absl::StatusCode::kUnknown) << code;
      EXPECT_THAT(std::string(made.message()), HasSubstr(product_));
    }
    server_.picture.mutable_problem()->set_code(3);
    EXPECT_EQ(Make(), absl::InvalidArgumentError(product_ + " was not made"));
  }
  EXPECT_FALSE(IsMade());
}

TEST_F(JobRunTest, NoMoreBytesAreReadThanWereAnnounced) {
  server_.send = [](FakeServer::Fetched& to) {
    if (!to.Write(FakeServer::Part("the picture", 100))) return;
    // Ends when the client stops reading.
    while (to.Write(FakeServer::Part(std::string(1000, 'x'), std::uint64_t{1} << 60))) {
    }
  };
  EXPECT_EQ(Make().code(), absl::StatusCode::kDataLoss);
  server_.send = [](FakeServer::Fetched& to) {
    to.Write(FakeServer::Part("the picture", std::uint64_t{1} << 60));
  };
  EXPECT_EQ(Make().code(), absl::StatusCode::kDataLoss);
  EXPECT_FALSE(IsMade());
}

TEST_F(JobRunTest, BytesThatNeverFitTheirHashAreFetchedAFewTimes) {
  server_.picture.set_sha256(pipeline::Sha256("another picture"));
  const absl::Status made = Make();
  EXPECT_EQ(made.code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(made.message()), HasSubstr(product_));
  EXPECT_EQ(server_.fetches, 3);
  EXPECT_FALSE(IsMade());
}

TEST_F(JobRunTest, EmptyNewsBreakTheStream) {
  server_.empty_news = true;
  EXPECT_EQ(Make(), absl::OkStatus());
  EXPECT_EQ(server_.watches, 2);
}

TEST_F(JobRunTest, OnlySoManyJobsAreLookedUp) {
  server_.listed_jobs = 1000;
  EXPECT_EQ(Make(), absl::OkStatus());
  EXPECT_EQ(server_.asked_jobs, 200);
}

TEST_F(JobRunTest, ACostThatIsNoNumberLeavesTheManifestReadable) {
  server_.picture.set_milliseconds(std::nan(""));
  EXPECT_EQ(Make(), absl::OkStatus());
  EXPECT_EQ(Make(), absl::OkStatus());
  EXPECT_EQ(server_.fetches, 1);
}

}  // namespace
}  // namespace thunderhead::runs
