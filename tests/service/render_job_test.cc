// Tests of render jobs on a fake machine: every picture is drawn once, one failure does not affect
// others, only the owner has access, and jobs continue after a restart.
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <map>
#include <set>
#include <sstream>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/own_file.h"
#include "gmock/gmock.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "gtest/gtest.h"
#include "pipeline/sha256.h"
#include "store/sqlite_job_store.h"
#include "telemetry/metrics.h"
#include "tests/service/fake_service.h"
#include "tests/service/guarded_service.h"
#include "tests/support/figure.h"
#include "tests/support/manual_time.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"
#include "thunderhead/v1/job.grpc.pb.h"

namespace thunderhead::testing {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using ::testing::Contains;
using ::testing::HasSubstr;
using State = v1::RenderJobPictureState;
using JobStub = v1::RenderJobService::Stub;

double MsSince(steady_clock::time_point begun) {
  return std::chrono::duration<double, std::milli>(steady_clock::now() - begun).count();
}

v1::RenderJobPicture Picture(std::uint32_t time_index, const std::string& name = "") {
  v1::RenderJobPicture picture;
  *picture.mutable_scene() = SmallScene();
  picture.mutable_scene()->set_time_index(time_index);
  picture.set_name(name);
  return picture;
}

// Returns a picture that takes half an hour if a million samples take 200 ms. It does not end while
// a test runs.
v1::RenderJobPicture EndlessPicture() {
  v1::RenderJobPicture picture = Picture(0);
  picture.mutable_scene()->mutable_output()->set_width_px(8192);
  picture.mutable_scene()->mutable_output()->set_height_px(1024);
  picture.mutable_scene()->mutable_rendering()->mutable_light_volume()->set_slices(1024);
  return picture;
}

std::string ReasonOf(const grpc::Status& status, bool* retries = nullptr) {
  google::rpc::Status details;
  std::string reason;
  details.ParseFromString(status.error_details());
  for (const auto& detail : details.details()) {
    google::rpc::ErrorInfo info;
    if (detail.UnpackTo(&info)) reason = info.reason();
    google::rpc::RetryInfo retry;
    if (retries != nullptr && detail.UnpackTo(&retry)) *retries = true;
  }
  return reason;
}

struct Fetched {
  grpc::Status status;
  std::string bytes;
  v1::FetchRenderResultResponse first;
};

// A client that calls with one identity. With an empty role it shows no token.
class Jobs {
 public:
  explicit Jobs(service::Server& server, std::string role = "")
      : stub_(v1::RenderJobService::NewStub(server.LocalChannel())), role_(std::move(role)) {}

  template <typename Method, typename Request, typename Response>
  grpc::Status Call(Method method, const Request& request, Response* response) {
    grpc::ClientContext context;
    Prepare(context);
    return (stub_.get()->*method)(&context, request, response);
  }

  grpc::Status Create(const std::vector<v1::RenderJobPicture>& pictures, v1::RenderJob* job,
                      const std::string& label = "") {
    v1::CreateRenderJobRequest request;
    request.set_label(label);
    for (const v1::RenderJobPicture& picture : pictures) *request.add_pictures() = picture;
    v1::CreateRenderJobResponse response;
    const grpc::Status status = Call(&JobStub::CreateRenderJob, request, &response);
    *job = response.job();
    return status;
  }

  v1::RenderJob Create(const std::vector<v1::RenderJobPicture>& pictures) {
    v1::RenderJob job;
    const grpc::Status status = Create(pictures, &job);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return job;
  }

  grpc::Status Get(const std::string& id, v1::GetRenderJobResponse* response) {
    v1::GetRenderJobRequest request;
    request.set_job_id(id);
    return Call(&JobStub::GetRenderJob, request, response);
  }

  v1::GetRenderJobResponse Get(const std::string& id) {
    v1::GetRenderJobResponse response;
    const grpc::Status status = Get(id, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }

  grpc::Status Cancel(const std::string& id, bool forget = false) {
    v1::CancelRenderJobRequest request;
    request.set_job_id(id);
    request.set_forget(forget);
    v1::CancelRenderJobResponse response;
    return Call(&JobStub::CancelRenderJob, request, &response);
  }

  // Watches until the stream ends, and collects the newest state of every picture.
  grpc::Status Watch(const std::string& id, std::map<std::uint32_t, State>* pictures,
                     std::atomic<int>* messages = nullptr) {
    grpc::ClientContext context;
    Prepare(context);
    v1::WatchRenderJobRequest request;
    request.set_job_id(id);
    const auto reader = stub_->WatchRenderJob(&context, request);
    v1::WatchRenderJobResponse news;
    while (reader->Read(&news)) {
      if (messages != nullptr) ++*messages;
      for (const State& picture : news.pictures()) (*pictures)[picture.index()] = picture;
    }
    return reader->Finish();
  }

  Fetched Fetch(const std::string& id, std::uint32_t index, std::uint64_t offset = 0) {
    grpc::ClientContext context;
    Prepare(context);
    v1::FetchRenderResultRequest request;
    request.set_job_id(id);
    request.set_index(index);
    request.set_offset(offset);
    const auto reader = stub_->FetchRenderResult(&context, request);
    Fetched fetched;
    v1::FetchRenderResultResponse part;
    while (reader->Read(&part)) {
      if (fetched.bytes.empty()) fetched.first = part;
      fetched.bytes += part.chunk();
    }
    fetched.status = reader->Finish();
    return fetched;
  }

 private:
  void Prepare(grpc::ClientContext& context) {
    context.set_deadline(std::chrono::system_clock::now() + 3 * kPatience);
    if (!role_.empty()) context.AddMetadata("authorization", "Bearer " + TokenOf(role_));
  }

  const std::unique_ptr<JobStub> stub_;
  const std::string role_;
};

class RenderJobTest : public ::testing::Test {
 protected:
  service::ServerOptions Options(const base::TimeSource& time = base::SteadyTime()) const {
    service::ServerOptions options = Patient(time);
    auto file = store::StateFile::Open(folder_.File("state.db"));
    EXPECT_TRUE(file.ok()) << file.status();
    options.jobs.store = *store::SqliteJobStore::In(*file);
    options.jobs.folder = folder_.File("jobs");
    return options;
  }

  std::size_t Files() const {
    std::size_t files = 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(folder_.File("jobs"))) {
      files += file.is_regular_file() && file.path().extension() == ".png" ? 1 : 0;
    }
    return files;
  }

  const TemporaryFolder folder_;
};

TEST_F(RenderJobTest, TextsOfClientsArePrintable) {
  FakeService service(Options());
  Jobs jobs(service.server());
  v1::RenderJob job;
  v1::RenderJobPicture picture = Picture(0, "seen\u200ffrom\u061cbelow");
  ASSERT_TRUE(jobs.Create({picture}, &job, "night\u202e\nrun").ok());
  const v1::GetRenderJobResponse got = jobs.Get(job.id());
  EXPECT_EQ(got.job().label(), "night??run");
  EXPECT_EQ(got.pictures(0).name(), "seen?from?below");
}

TEST_F(RenderJobTest, DrawsEveryPictureOnceAndKeepsItUntilItIsFetched) {
  FakeService service(Options());
  Jobs jobs(service.server());
  const v1::RenderJob job = jobs.Create({Picture(0, "a"), Picture(1, "b"), Picture(2, "c")});
  EXPECT_EQ(job.state(), v1::RenderJob::STATE_RUNNING);
  EXPECT_EQ(job.counts().waiting(), 3U);
  std::map<std::uint32_t, State> pictures;
  ASSERT_TRUE(jobs.Watch(job.id(), &pictures).ok());
  ASSERT_EQ(pictures.size(), 3U);
  for (std::uint32_t i = 0; i < 3; ++i) {
    ASSERT_EQ(pictures[i].state(), State::STATE_DRAWN) << pictures[i].ShortDebugString();
    const Fetched fetched = jobs.Fetch(job.id(), i);
    ASSERT_TRUE(fetched.status.ok()) << fetched.status.error_message();
    EXPECT_EQ(pipeline::Sha256(fetched.bytes), pictures[i].sha256());
    EXPECT_EQ(fetched.bytes.size(), pictures[i].bytes());
    EXPECT_EQ(fetched.first.picture().scene().time_index(), i);
    EXPECT_EQ(fetched.first.input().storm_id(), "anvil");
    EXPECT_EQ(fetched.first.input().valid_time(),
              absl::StrCat("0001-01-01T00:", 10 + 10 * i, ":00Z"));
    EXPECT_EQ(jobs.Fetch(job.id(), i, 10).bytes, fetched.bytes.substr(10));
    // Any client that knows the path can fetch the file by HTTP.
    const auto file = service.server().FindResult(absl::StrCat(job.result_path(), "/", i));
    ASSERT_TRUE(file.has_value());
    std::stringstream contents;
    contents << std::ifstream(file->path, std::ios::binary).rdbuf();
    EXPECT_EQ(contents.str(), fetched.bytes);
  }
  EXPECT_EQ(pictures[0].name(), "a");
  EXPECT_EQ(service.machine->Log().size(), 3U);
  for (const char* other : {"/+0", "/00", "/-0", "/ 0", "/0 ", "/01", "/0x0", "/", ""}) {
    EXPECT_FALSE(service.server().FindResult(job.result_path() + other).has_value()) << other;
  }
  EXPECT_FALSE(service.server().FindResult(absl::StrCat("/results/", job.id(), "/0")).has_value())
      << "the id is no key";
  EXPECT_EQ(jobs.Get(job.id()).job().state(), v1::RenderJob::STATE_DONE);
  EXPECT_TRUE(jobs.Cancel(job.id(), true).ok());
  v1::GetRenderJobResponse gone;
  EXPECT_EQ(jobs.Get(job.id(), &gone).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(Files(), 0U);
}

TEST_F(RenderJobTest, APictureFailsByItself) {
  FakeService service(Options());
  Jobs jobs(service.server());
  v1::RenderJobPicture wrong = Picture(0);
  wrong.mutable_scene()->mutable_sun()->set_azimuth_deg(1e6F);
  v1::RenderJobPicture unknown = Picture(0);
  unknown.mutable_scene()->set_storm_id("nowhere");
  service.store->FailAt(3, absl::DataLossError("anvil.nc: variable QRAIN is cut short"));
  const v1::RenderJob job = jobs.Create({wrong, Picture(99), unknown, Picture(3), Picture(1)});
  std::map<std::uint32_t, State> pictures;
  ASSERT_TRUE(jobs.Watch(job.id(), &pictures).ok());
  const auto expect = [&](std::uint32_t index, int code, const std::string& words) {
    EXPECT_EQ(pictures[index].state(), State::STATE_FAILED);
    EXPECT_EQ(pictures[index].problem().code(), code);
    EXPECT_THAT(pictures[index].problem().message(), HasSubstr(words));
    EXPECT_FALSE(pictures[index].problem().reason().empty());
  };
  expect(0, grpc::StatusCode::INVALID_ARGUMENT, "azimuth_deg");
  expect(1, grpc::StatusCode::INVALID_ARGUMENT, "scene.time_index is 99");
  expect(2, grpc::StatusCode::NOT_FOUND, "nowhere");
  expect(3, grpc::StatusCode::DATA_LOSS, "QRAIN is cut short");
  EXPECT_EQ(pictures[4].state(), State::STATE_DRAWN);
  EXPECT_EQ(jobs.Get(job.id()).job().state(), v1::RenderJob::STATE_DONE);
  EXPECT_EQ(jobs.Fetch(job.id(), 0).status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(jobs.Fetch(job.id(), 9).status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(RenderJobTest, GoesOnAfterARestartAndDrawsNothingTwice) {
  std::string id;
  std::size_t drawn = 0;
  {
    FakeService service(Options());
    Jobs jobs(service.server());
    service.machine->drawing.Close();
    std::vector<v1::RenderJobPicture> pictures;
    for (int i = 0; i < 12; ++i) pictures.push_back(Picture(static_cast<std::uint32_t>(i % 4)));
    id = jobs.Create(pictures).id();
    // A drawn picture ends only when the device is free. The next picture may hold the device while
    // it waits at the gate, so more pictures than three are let through.
    constexpr std::size_t kInHand = 3;
    for (std::size_t i = 0; i < kInHand + 3; ++i) service.machine->drawing.LetOnePass();
    ASSERT_TRUE(WaitFor([&] { return jobs.Get(id).job().counts().drawn() >= 3; }));
    drawn = jobs.Get(id).job().counts().drawn();
    service.server().BeginDrain();
    v1::RenderJob refused;
    EXPECT_EQ(jobs.Create({Picture(0)}, &refused).error_code(), grpc::StatusCode::UNAVAILABLE);
  }
  ASSERT_LT(drawn, 12U);
  FakeService service(Options());
  Jobs jobs(service.server());
  std::map<std::uint32_t, State> pictures;
  ASSERT_TRUE(jobs.Watch(id, &pictures).ok());
  EXPECT_EQ(jobs.Get(id).job().counts().drawn(), 12U);
  // The pictures in progress when the first server ended were drawn by either server.
  EXPECT_LE(service.machine->Log().size(), 12U - drawn);
  EXPECT_EQ(Files(), 12U);
  for (std::uint32_t i = 0; i < 12; ++i) EXPECT_TRUE(jobs.Fetch(id, i).status.ok());
}

TEST_F(RenderJobTest, ATimeIsFoundAgainWhereItStandsNow) {
  FakeService service(Options());
  Jobs jobs(service.server());
  service.machine->drawing.Close();
  const v1::RenderJob job =
      jobs.Create({Picture(0), Picture(0), Picture(0), Picture(0), Picture(2)});
  ASSERT_TRUE(service.machine->drawing.AwaitWaiting(1));
  service.store->Become("anvil", [](storm_store::StormInfo& storm) {
    storm.times.insert(storm.times.begin(), {"0001-01-01T00:00:00Z", -600.0});
  });
  service.machine->drawing.Open();
  std::map<std::uint32_t, State> pictures;
  ASSERT_TRUE(jobs.Watch(job.id(), &pictures).ok());
  EXPECT_EQ(jobs.Fetch(job.id(), 4).first.picture().scene().time_index(), 3U);
  EXPECT_EQ(jobs.Fetch(job.id(), 4).first.input().valid_time(), "0001-01-01T00:30:00Z");
}

// The file of one time lies on a storage that hangs; the others lie elsewhere.
TEST_F(RenderJobTest, AStorageThatHangsHoldsUpOnlyItsOwnPictures) {
  std::promise<void> storage;
  std::atomic<int> hanging{0};
  ManualTime time;
  service::ServerOptions options = Options(time);
  options.job_files.stamp = [&hanging,
                             answers = storage.get_future().share()](const std::string& path) {
    if (path.starts_with("/gone/")) {
      ++hanging;
      answers.wait();
    }
    return base::FileStamp{};
  };
  FakeService service(options);
  service.store->Become("anvil", [](storm_store::StormInfo& storm) {
    for (std::size_t i = 0; i < storm.times.size(); ++i) {
      storm.times[i].file = absl::StrCat(i == 1 ? "/gone/" : "/data/", i);
    }
  });
  Jobs jobs(service.server());
  const v1::RenderJob job = jobs.Create({Picture(1), Picture(1), Picture(0), Picture(2)});
  ASSERT_TRUE(WaitFor([&] { return hanging == 1; }));
  time.Advance(options.job_files.patience);
  ASSERT_TRUE(WaitFor([&] { return jobs.Get(job.id()).job().counts().drawn() == 2; }));
  EXPECT_EQ(jobs.Get(job.id()).job().counts().waiting(), 2U) << "tried again later, none failed";
  storage.set_value();
}

TEST_F(RenderJobTest, AResultWhoseStorageHangsIsRefusedAndTheNextAtOnce) {
  ManualTime time;
  service::ServerOptions options = Options(time);
  std::atomic<bool> hangs{false};
  std::promise<void> storage;
  options.job_files.open_result =
      [&hangs, answers = storage.get_future().share()](const std::string& path) {
        if (hangs && path.ends_with("/000000.png")) answers.wait();
        return base::OpenOwnFile(path);
      };
  FakeService service(options);
  Jobs jobs(service.server());
  const v1::RenderJob job = jobs.Create({Picture(0), Picture(1)});
  ASSERT_TRUE(WaitFor([&] { return jobs.Get(job.id()).job().counts().drawn() == 2; }));
  ASSERT_TRUE(jobs.Fetch(job.id(), 1).status.ok());
  hangs = true;
  auto first = std::async(std::launch::async, [&] { return jobs.Fetch(job.id(), 0); });
  ASSERT_TRUE(WaitFor([&] {
    time.Advance(milliseconds(500));
    return first.wait_for(milliseconds(0)) == std::future_status::ready;
  }));
  // The next fetch does not wait longer.
  for (const Fetched& fetched : {first.get(), jobs.Fetch(job.id(), 0)}) {
    EXPECT_EQ(fetched.status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
    bool retries = false;
    EXPECT_EQ(ReasonOf(fetched.status, &retries), "STORAGE_HANGS");
    EXPECT_TRUE(retries);
  }
  // The storage responds again.
  storage.set_value();
  EXPECT_TRUE(WaitFor([&] { return jobs.Fetch(job.id(), 0).status.ok(); }));
}

TEST_F(RenderJobTest, AnAlteredResultIsNotGivenWhole) {
  FakeService service(Options());
  Jobs jobs(service.server());
  const v1::RenderJob job = jobs.Create({Picture(0)});
  ASSERT_TRUE(WaitFor([&] { return jobs.Get(job.id()).job().counts().drawn() == 1; }));
  const std::string folder = absl::StrCat(folder_.File("jobs"), "/", job.id());
  const std::string picture = folder + "/000000.png";
  const std::string about = folder + "/000000.about";
  const auto bytes = static_cast<std::uint64_t>(std::filesystem::file_size(picture));
  const auto expect_damaged = [&](const char* why) {
    for (const std::uint64_t offset : {std::uint64_t{0}, bytes / 2, bytes}) {
      const Fetched fetched = jobs.Fetch(job.id(), 0, offset);
      EXPECT_EQ(fetched.status.error_code(), grpc::StatusCode::DATA_LOSS) << why;
      EXPECT_EQ(ReasonOf(fetched.status), "RESULT_DAMAGED") << why;
      EXPECT_EQ(fetched.bytes, "") << why << ": its only chunk is the last";
    }
  };
  std::filesystem::copy(folder, folder + ".kept", std::filesystem::copy_options::recursive);
  const auto restore = [&] {
    std::filesystem::remove_all(folder);
    std::filesystem::copy(folder + ".kept", folder, std::filesystem::copy_options::recursive);
    EXPECT_TRUE(jobs.Fetch(job.id(), 0, bytes / 2).status.ok());
  };
  std::fstream(picture, std::ios::in | std::ios::out).seekp(1).put('!');
  expect_damaged("another byte");
  restore();
  std::filesystem::resize_file(picture, bytes - 1);
  expect_damaged("shorter");
  restore();
  std::ofstream(picture, std::ios::app) << "!";
  expect_damaged("longer");
  restore();
  for (const std::string& file : {picture, about}) {
    std::filesystem::remove(file);
    std::filesystem::create_symlink(
        folder + ".kept/" + std::filesystem::path(file).filename().string(), file);
    expect_damaged("a link to the same contents");
    restore();
    std::filesystem::remove(file);
    ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
    expect_damaged("a pipe");
    restore();
  }
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory_symlink(folder + ".kept", folder);
  expect_damaged("a link to the folder");
}

TEST_F(RenderJobTest, CancellingFreesTheDevice) {
  FakeService service(Options());
  Jobs jobs(service.server());
  service.machine->ms_per_mega_sample = 200.0;
  const v1::RenderJob job = jobs.Create({EndlessPicture(), EndlessPicture(), EndlessPicture()});
  ASSERT_TRUE(WaitFor([&] { return service.machine->pieces > 3; }));
  const auto cancelled = steady_clock::now();
  ASSERT_TRUE(jobs.Cancel(job.id()).ok());
  ASSERT_TRUE(WaitFor([&] { return service.server().Load().pictures == 0; }));
  Figure("device free after a job was cancelled", MsSince(cancelled), "ms");
  const int pieces = service.machine->pieces;
  std::map<std::uint32_t, State> pictures;
  ASSERT_TRUE(jobs.Watch(jobs.Create({Picture(1)}).id(), &pictures).ok());
  EXPECT_EQ(pictures[0].state(), State::STATE_DRAWN);
  EXPECT_EQ(service.machine->pieces, pieces + 1) << "the next has one";
  const v1::RenderJob ended = jobs.Get(job.id()).job();
  EXPECT_EQ(ended.state(), v1::RenderJob::STATE_CANCELLED);
  EXPECT_EQ(ended.counts().drawing() + ended.counts().waiting(), 0U);
}

// The server checks the token again after it has sent an update.
TEST_F(RenderJobTest, ATokenThatIsTakenAwayEndsItsWatch) {
  ManualTime time;
  GuardedService guarded(Options(time));
  FakeMachine& machine = *guarded.service().machine;
  machine.drawing.Close();
  Jobs pipeline(guarded.service().server(), "pipeline");
  const v1::RenderJob job = pipeline.Create(std::vector<v1::RenderJobPicture>(400, Picture(0)));
  std::atomic<int> messages{0};
  auto watched = std::async(std::launch::async, [&] {
    std::map<std::uint32_t, State> pictures;
    return pipeline.Watch(job.id(), &pictures, &messages);
  });
  ASSERT_TRUE(WaitFor([&] { return messages > 0; }));
  guarded.TakeAwayToken("pipeline");
  ASSERT_TRUE(WaitFor([&] {
    time.Advance(milliseconds(500));
    if (machine.drawing.Waiting() > 0) machine.drawing.LetOnePass();
    return watched.wait_for(milliseconds(0)) == std::future_status::ready;
  }));
  EXPECT_EQ(watched.get().error_code(), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_THAT(guarded.Audit(), Contains(::testing::AllOf(HasSubstr("act=WatchRenderJob "),
                                                         HasSubstr("TOKEN_UNKNOWN"))));
}

TEST_F(RenderJobTest, IsItsOwnersAlone) {
  GuardedService guarded(Options());
  Jobs pipeline(guarded.service().server(), "pipeline");
  Jobs presenter(guarded.service().server(), "presenter");
  Jobs viewer(guarded.service().server(), "viewer");
  Jobs op(guarded.service().server(), "operator");
  const v1::RenderJob job = pipeline.Create({Picture(0)});
  v1::RenderJob none;
  EXPECT_EQ(viewer.Create({Picture(0)}, &none).error_code(), grpc::StatusCode::PERMISSION_DENIED);
  std::map<std::uint32_t, State> pictures;
  ASSERT_TRUE(pipeline.Watch(job.id(), &pictures).ok());
  v1::GetRenderJobResponse got;
  EXPECT_EQ(presenter.Get(job.id(), &got).error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(presenter.Watch(job.id(), &pictures).error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(presenter.Fetch(job.id(), 0).status.error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(presenter.Cancel(job.id()).error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_TRUE(op.Get(job.id(), &got).ok());
  v1::ListRenderJobsRequest list;
  v1::ListRenderJobsResponse listed;
  ASSERT_TRUE(presenter.Call(&JobStub::ListRenderJobs, list, &listed).ok());
  EXPECT_EQ(listed.jobs_size(), 0);
  ASSERT_TRUE(pipeline.Call(&JobStub::ListRenderJobs, list, &listed).ok());
  EXPECT_EQ(listed.jobs_size(), 1);
  list.set_everybodys(true);
  EXPECT_EQ(pipeline.Call(&JobStub::ListRenderJobs, list, &listed).error_code(),
            grpc::StatusCode::PERMISSION_DENIED);
  ASSERT_TRUE(op.Call(&JobStub::ListRenderJobs, list, &listed).ok());
  EXPECT_EQ(listed.jobs_size(), 1);
  EXPECT_TRUE(op.Cancel(job.id(), true).ok());
  const std::vector<std::string> audit = guarded.Audit();
  const auto has = [&](const std::string& part) { EXPECT_THAT(audit, Contains(HasSubstr(part))); };
  has("identity=\"a-pipeline\" role=pipeline peer=\"\" act=CreateRenderJob verdict=allowed");
  has("identity=\"a-presenter\" role=presenter peer=\"\" act=GetRenderJob verdict=refused "
      "reason=\"NOT_YOUR_JOB\"");
  has("identity=\"a-presenter\" role=presenter peer=\"\" act=CancelRenderJob verdict=refused");
  has("identity=\"a-operator\" role=operator peer=\"\" act=CancelRenderJob verdict=allowed");
  for (const std::string& line : audit) EXPECT_EQ(line.find(job.id()), std::string::npos);
}

TEST_F(RenderJobTest, MoreThanIsAllowedIsRefusedWithATimeToTryAgain) {
  service::ServerOptions options = Options();
  options.jobs.limits.max_jobs_per_owner = 2;
  options.jobs.limits.max_pictures_per_owner = 5;
  FakeService service(options);
  service.machine->drawing.Close();
  Jobs jobs(service.server());
  const v1::RenderJob first = jobs.Create({Picture(0), Picture(1)});
  v1::RenderJob job;
  bool retries = false;
  grpc::Status refused = jobs.Create({Picture(0), Picture(0), Picture(0), Picture(0)}, &job);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(ReasonOf(refused, &retries), "TOO_MANY_JOB_PICTURES");
  EXPECT_TRUE(retries);
  jobs.Create({Picture(2)});
  refused = jobs.Create({Picture(0)}, &job);
  EXPECT_EQ(ReasonOf(refused), "TOO_MANY_JOBS");
  EXPECT_EQ(jobs.Create({}, &job).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  // A job that has ended no longer counts towards the limit, so another job can be created.
  ASSERT_TRUE(jobs.Cancel(first.id()).ok());
  EXPECT_TRUE(jobs.Create({Picture(0)}, &job).ok());
  v1::GetRenderJobResponse gone;
  EXPECT_EQ(jobs.Get(first.id(), &gone).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(RenderJobTest, WhereNobodyFetchesDrawingPausesAndGoesOnAfterAFetch) {
  service::ServerOptions options = Options();
  options.jobs.limits.max_result_bytes = 1;
  FakeService service(options);
  Jobs jobs(service.server());
  const v1::RenderJob job = jobs.Create(std::vector<v1::RenderJobPicture>(6, Picture(0)));
  // Some pictures were already in progress when the first picture was drawn.
  ASSERT_TRUE(WaitFor([&] { return jobs.Get(job.id()).job().has_paused(); }));
  const auto drawn = [&] { return jobs.Get(job.id()).job().counts().drawn(); };
  ASSERT_TRUE(WaitFor([&] { return jobs.Get(job.id()).job().counts().drawing() == 0; }));
  const auto paused = jobs.Get(job.id()).job();
  EXPECT_EQ(paused.paused().reason(), "RESULTS_NOT_FETCHED");
  EXPECT_THAT(paused.paused().message(), HasSubstr("--jobs-quota"));
  EXPECT_EQ(paused.counts().dropped(), 0U) << "nothing drawn is thrown away";
  EXPECT_LE(paused.counts().drawn(), 4U) << "three in hand, and one that replaced the first";
  EXPECT_EQ(service.server().Load().jobs.paused, paused.counts().waiting());
  // Pictures fetched by gRPC and by HTTP count alike.
  std::uint32_t fetched = 0;
  while (jobs.Get(job.id()).job().state() == v1::RenderJob::STATE_RUNNING && fetched < 6) {
    ASSERT_TRUE(WaitFor([&] {
      const auto got = jobs.Get(job.id());
      return got.pictures(static_cast<int>(fetched)).state() == State::STATE_DRAWN;
    })) << fetched
        << " fetched, " << drawn() << " drawn";
    if (fetched % 2 == 0) {
      ASSERT_TRUE(jobs.Fetch(job.id(), fetched).status.ok());
    } else {
      service.server().ResultFetched(absl::StrCat(job.result_path(), "/", fetched));
    }
    ++fetched;
  }
  EXPECT_EQ(service.machine->Log().size(), 6U) << "each once";
  // Fetching a picture frees its space, and the job reports it.
  const auto got = jobs.Get(job.id());
  EXPECT_FALSE(got.job().has_paused());
  EXPECT_GT(got.job().counts().dropped(), 0U);
  for (const State& picture : got.pictures()) {
    if (picture.state() != State::STATE_DROPPED) continue;
    EXPECT_THAT(picture.problem().message(), HasSubstr("--jobs-quota"));
    EXPECT_EQ(jobs.Fetch(job.id(), picture.index()).status.error_code(),
              grpc::StatusCode::NOT_FOUND);
  }
  // Paths that do not name a result are ignored.
  service.server().ResultFetched(job.result_path() + "/99");
  service.server().ResultFetched("/results/nobody/0");
}

TEST_F(RenderJobTest, AServerWithoutAFolderSaysSo) {
  FakeService service;
  Jobs jobs(service.server());
  v1::RenderJob job;
  const grpc::Status status = jobs.Create({Picture(0)}, &job);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), HasSubstr("--jobs-folder"));
}

TEST_F(RenderJobTest, SinglePicturesGoBeforeThoseOfJobs) {
  FakeService service(Options());
  Jobs jobs(service.server());
  service.machine->next_piece.Close();
  std::vector<v1::RenderJobPicture> many(20, Picture(0));
  const v1::RenderJob job = jobs.Create(many);
  ASSERT_TRUE(service.machine->next_piece.AwaitWaiting(1));
  std::thread caller([&] {
    v1::RenderImageRequest request;
    *request.mutable_scene() = SmallScene();
    request.mutable_scene()->mutable_display()->set_exposure_ev(3.0F);
    v1::RenderImageResponse response;
    EXPECT_TRUE(
        Call(service.stub(), &v1::ThunderheadService::Stub::RenderImage, request, &response).ok());
  });
  ASSERT_TRUE(WaitFor([&] { return service.server().Load().pictures == 4; }));
  const int pieces = service.machine->PiecesUntil(
      [](const FakeMachine::Drawn& drawn) { return drawn.scene.display.exposure_ev == 3.0; });
  EXPECT_GE(pieces, 0);
  EXPECT_LE(pieces, 12) << "of 20, each of one piece";
  service.machine->next_piece.Open();
  caller.join();
  std::map<std::uint32_t, State> pictures;
  EXPECT_TRUE(jobs.Watch(job.id(), &pictures).ok());
}

TEST_F(RenderJobTest, ImagesOfTenJobsBesideADraggingSessionAllComplete) {
  FakeService service(Options());
  Jobs jobs(service.server());
  const std::string session = service.Open(SmallScene());
  Watcher watcher(service.stub(), session);
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  std::vector<std::string> ids;
  for (int i = 0; i < 10; ++i) {
    std::vector<v1::RenderJobPicture> pictures;
    for (std::uint32_t k = 0; k < 10; ++k) pictures.push_back(Picture(k % 4));
    ids.push_back(jobs.Create(pictures).id());
  }
  const auto drawn = [&] {
    std::uint32_t all = 0;
    for (const std::string& id : ids) all += jobs.Get(id).job().counts().drawn();
    return all;
  };
  for (int i = 0; drawn() < 100; ++i) {
    v1::Scene scene = SmallScene();
    scene.mutable_camera()->mutable_orbit()->set_azimuth_deg(static_cast<float>(i % 360));
    ASSERT_TRUE(watcher.AwaitFrame(service.Update(session, scene), false));
  }
  for (const std::string& id : ids) {
    EXPECT_EQ(jobs.Get(id).job().state(), v1::RenderJob::STATE_DONE);
  }
}

class RenderJobBenchmark : public RenderJobTest {};

TEST_F(RenderJobBenchmark, MovingFramesBesideFiveHundredImagesOfTenJobs) {
  FakeService service(Options());
  Jobs jobs(service.server());
  service.machine->ms_per_mega_sample = 100.0;  // 3.7 ms for each picture
  const std::string session = service.Open(SmallScene());
  Watcher watcher(service.stub(), session);
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  std::vector<std::string> ids;
  for (int i = 0; i < 10; ++i) {
    std::vector<v1::RenderJobPicture> pictures;
    for (std::uint32_t k = 0; k < 50; ++k) pictures.push_back(Picture(k % 4));
    ids.push_back(jobs.Create(pictures).id());
  }
  std::vector<double> latencies_ms;
  const auto drawn = [&] {
    std::uint32_t all = 0;
    for (const std::string& id : ids) all += jobs.Get(id).job().counts().drawn();
    return all;
  };
  const auto begun = steady_clock::now();
  for (int i = 0; drawn() < 500; ++i) {
    v1::Scene scene = SmallScene();
    scene.mutable_camera()->mutable_orbit()->set_azimuth_deg(static_cast<float>(i % 360));
    const auto updated = steady_clock::now();
    ASSERT_TRUE(watcher.AwaitFrame(service.Update(session, scene), false));
    latencies_ms.push_back(MsSince(updated));
  }
  Figure("500 images of 10 jobs beside a moving session", 1e-3 * MsSince(begun), "s");
  ASSERT_FALSE(latencies_ms.empty());
  std::ranges::sort(latencies_ms);
  Figure("moving frame beside jobs, median", latencies_ms[latencies_ms.size() / 2], "ms");
  Figure("moving frame beside jobs, 95th percentile", latencies_ms[latencies_ms.size() * 95 / 100],
         "ms");
}

TEST(RenderImageInChunks, GivesTheSamePicture) {
  FakeService service;
  v1::RenderImageRequest request;
  *request.mutable_scene() = SmallScene();
  request.mutable_scene()->mutable_output()->set_width_px(1600);
  request.mutable_scene()->mutable_output()->set_height_px(1000);
  request.set_format(v1::IMAGE_FORMAT_PNG);
  v1::RenderImageResponse whole;
  ASSERT_TRUE(
      Call(service.stub(), &v1::ThunderheadService::Stub::RenderImage, request, &whole).ok());
  request.set_in_chunks(true);
  grpc::ClientContext context;
  const auto reader = service.stub().RenderImageWithProgress(&context, request);
  v1::RenderImageEvent event;
  std::string image;
  v1::RenderImageResponse last;
  while (reader->Read(&event)) {
    EXPECT_LE(event.ByteSizeLong(), (std::size_t{1} << 20) + 8192);
    if (event.has_chunk()) image += event.chunk();
    if (event.has_image()) last = event.image();
  }
  ASSERT_TRUE(reader->Finish().ok());
  EXPECT_TRUE(last.image().empty());
  EXPECT_EQ(last.width_px(), 1600U);
  EXPECT_EQ(image, whole.image());
}

}  // namespace
}  // namespace thunderhead::testing
