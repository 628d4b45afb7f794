// Tests of the program on a storage that hangs. hanging_storage.cc blocks the calls that a test
// chooses and advances the program's clock. No test therefore waits for a timeout or takes a slow
// read for a hang.
#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <regex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/gateway/raw_client.h"
#include "tests/service/hanging_storage.h"
#include "tests/service/interacting.h"
#include "tests/service/running_program.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"
#include "thunderhead/v1/job.grpc.pb.h"

namespace thunderhead::testing {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using Response = v1::InteractResponse;
using Stub = v1::ThunderheadService::Stub;

void WriteStorm(const std::string& path) {
  SyntheticWrf storm;
  storm.nx = 16;
  storm.ny = 16;
  storm.mixing_ratios["QCLOUD"] = [](const WrfCell& cell) { return cell.level < 4 ? 1e-3 : 0.0; };
  WriteWrf(storm, path);
}

// Makes the contents of the folder appear on a separate device from now on.
void Mount(const std::string& folder) { std::ofstream(folder + ".mounted"); }

// The monotonic clock of a program that has loaded hanging_storage.cc.
class ProgramClock {
 public:
  explicit ProgramClock(const std::string& path)
      : file_(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    Advance(seconds(0));
  }
  ~ProgramClock() { close(file_); }
  ProgramClock(const ProgramClock&) = delete;
  ProgramClock& operator=(const ProgramClock&) = delete;

  // Advances the clock. Call it from one thread at a time.
  void Advance(std::chrono::nanoseconds by) {
    ahead_ns_ += by.count();
    EXPECT_EQ(pwrite(file_, &ahead_ns_, sizeof(ahead_ns_), 0), sizeof(ahead_ns_));
  }

 private:
  const int file_;
  std::int64_t ahead_ns_ = 0;
};

v1::Scene SceneOf(const std::string& storm) {
  v1::Scene scene;
  scene.set_storm_id(storm);
  scene.mutable_output()->set_width_px(64);
  scene.mutable_output()->set_height_px(36);
  return scene;
}

class HungStorageTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!kHasHangingStorage) GTEST_SKIP() << "a sanitizer must be the program's first library";
  }

  void Start(const std::vector<std::string>& data, const std::string& state = "none",
             const std::vector<std::string>& more = {}) {
    const HangingStorage hanging(clock_path_);
    std::vector<std::string> arguments{"serve",       "--device", "software",    "--http",
                                       "127.0.0.1:0", "--grpc",   "127.0.0.1:0", "--metrics",
                                       "127.0.0.1:0", "--state",  state,         "--rescan-seconds",
                                       "0",           "--data"};
    arguments.insert(arguments.end(), data.begin(), data.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    program_ = std::make_unique<RunningProgram>(PROGRAM, arguments, out_, err_);
  }

  static std::string Contents(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  // Returns the first group of `pattern` once the program has written it to `path`. Returns "" if
  // the program ends before.
  std::string Await(const std::string& path, const std::string& pattern) {
    const std::regex wanted(pattern);
    std::smatch found;
    std::string text;
    const auto has_come = [&] {
      text = Contents(path);
      return std::regex_search(text, found, wanted);
    };
    WaitFor([&] { return has_come() || !program_->Runs(); });
    return has_come() ? found[1] : std::string();
  }

  // Makes a call that will hang at `path`, and advances the program's time until the call returns.
  template <typename MakeCall>
  auto AnswerWhereHangs(const std::string& path, MakeCall call) {
    const std::jthread passing([&](const std::stop_token& answered) {
      while (!answered.stop_requested()) {
        if (Hangs(path)) clock_.Advance(seconds(5));
        std::this_thread::sleep_for(milliseconds(5));
      }
    });
    return call();
  }

  // Waits until the program warns that the storage at `path` does not respond. Returns the number
  // of seconds without a response that the warning reports; 0 if the program ends before.
  double AwaitWarningOf(const std::string& path) {
    const std::string said = AnswerWhereHangs(path, [&] {
      return Await(err_, fs::path(path).filename().string() +
                             ": has not answered for ([0-9.]+) s; its storage");
    });
    return said.empty() ? 0.0 : std::stod(said);
  }

  void AwaitReady() {
    const std::string grpc = Await(out_, "is ready at .*\\(gRPC ([0-9.:]+)\\)");
    ASSERT_NE(grpc, "") << Contents(err_);
    http_port_ = PortIn(Await(out_, "is ready at http://[0-9.]+:([0-9]+)/"));
    const auto channel = grpc::CreateChannel(grpc, grpc::InsecureChannelCredentials());
    stub_ = v1::ThunderheadService::NewStub(channel);
    jobs_stub_ = v1::RenderJobService::NewStub(channel);
  }
  // Starts the program with a storm and a folder for clouds.
  void StartWithClouds() {
    fs::create_directory(folder_.File("clouds"));
    WriteStorm(folder_.File("anvil.nc"));
    Start({folder_.File("anvil.nc")}, "none", {"--clouds", folder_.File("clouds")});
    AwaitReady();
  }
  void AwaitOperatorsPort() {
    operators_port_ = PortIn(Await(err_, "operators at http://[0-9.]+:([0-9]+)/"));
    ASSERT_NE(operators_port_, 0) << Contents(err_);
  }

  static std::uint16_t PortIn(const std::string& text) {
    return text.empty() ? 0 : static_cast<std::uint16_t>(std::stoi(text));
  }
  static int CodeOf(std::uint16_t port, const std::string& path) {
    return gateway::test::RawClient(port).Ask("GET", path).result_int();
  }
  static std::string BodyOf(std::uint16_t port, const std::string& path) {
    return gateway::test::RawClient(port).Ask("GET", path).body();
  }

  // Waits until the operators' port answers 200. A frame that was being drawn while the program's
  // clock was advanced counts as stuck until it is drawn.
  bool BecomesHealthy(const std::string& path) const {
    return WaitFor([&] { return CodeOf(operators_port_, path) == 200; });
  }

  grpc::Status Draw(const std::string& storm) {
    v1::RenderImageRequest request;
    *request.mutable_scene() = SceneOf(storm);
    v1::RenderImageResponse response;
    return Call(*stub_, &Stub::RenderImage, request, &response);
  }

  // Returns the exit code after SIGTERM. Advances the program's time so that it abandons the calls
  // that hang.
  int CodeAfterSigterm() {
    program_->Signal(SIGTERM);
    WaitFor([&] {
      clock_.Advance(milliseconds(100));
      return !program_->Runs();
    });
    return program_->Runs() ? -1 : program_->Wait().code;
  }

  const TemporaryFolder folder_;
  const std::string out_ = folder_.File("out");
  const std::string err_ = folder_.File("err");
  const std::string clock_path_ = folder_.File("clock");
  ProgramClock clock_{clock_path_};
  std::uint16_t http_port_ = 0;
  std::uint16_t operators_port_ = 0;
  std::unique_ptr<Stub> stub_;
  std::unique_ptr<v1::RenderJobService::Stub> jobs_stub_;
  std::unique_ptr<RunningProgram> program_;
};

TEST_F(HungStorageTest, OnlyItsOwnStormIsHeldUpAndTheProgramEndsWhenItIsTold) {
  fs::create_directory(folder_.File("data"));
  Mount(folder_.File("data"));
  fs::create_directory(folder_.File("other"));
  const std::string far = folder_.File("data/tower.nc");
  // At its start the program draws the first storm, and therefore reads its file.
  WriteStorm(folder_.File("data/anvil.nc"));
  WriteStorm(far);
  // The two files have the same valid time, so they are separate storms instead of one series.
  WriteStorm(folder_.File("other/plume.nc"));
  WriteStorm(folder_.File("other/wall.nc"));
  Start({folder_.File("data"), folder_.File("other")});
  AwaitReady();
  AwaitOperatorsPort();
  ASSERT_FALSE(HasFatalFailure());
  ASSERT_TRUE(Draw("anvil").ok());
  HangAt(far);

  v1::CreateSessionRequest request;
  *request.mutable_scene() = SceneOf("tower");
  v1::CreateSessionResponse created;
  // The call must be answered, whether or not a session opens.
  AnswerWhereHangs(far, [&] { return Call(*stub_, &Stub::CreateSession, request, &created); });
  const grpc::Status late = AnswerWhereHangs(far, [&] { return Draw("tower"); });
  EXPECT_EQ(late.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED) << late.error_message();
  EXPECT_THAT(late.error_message(), HasSubstr("tower.nc"));
  EXPECT_EQ(ReasonOf(late), "STORAGE_HANGS");

  EXPECT_EQ(CodeOf(http_port_, "/healthz"), 200);
  EXPECT_TRUE(BecomesHealthy("/healthz"));
  EXPECT_TRUE(BecomesHealthy("/readyz"));
  EXPECT_TRUE(Draw("anvil").ok());
  // Another process reads the other device.
  const grpc::Status beside = Draw("plume");
  EXPECT_TRUE(beside.ok()) << beside.error_message();
  *request.mutable_scene() = SceneOf("anvil");
  ASSERT_TRUE(Call(*stub_, &Stub::CreateSession, request, &created).ok());
  {
    Interacting viewer(*stub_, created.viewer_key());
    EXPECT_TRUE(viewer.AwaitFrame(created.scene_revision()));
  }
  EXPECT_EQ(CodeAfterSigterm(), 0) << Contents(err_);
}

TEST_F(HungStorageTest, AStartThatHangsSaysWhereAndEndsWhenItIsTold) {
  const std::string storm = folder_.File("storm.nc");
  WriteStorm(storm);
  HangAt(storm);
  Start({storm});
  AwaitOperatorsPort();
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_EQ(CodeOf(operators_port_, "/healthz"), 200);
  EXPECT_EQ(CodeOf(operators_port_, "/readyz"), 503);
  EXPECT_GE(AwaitWarningOf(storm), 10.0) << Contents(err_);
  EXPECT_EQ(CodeAfterSigterm(), 0) << Contents(err_);
}

TEST_F(HungStorageTest, AStateFolderThatHangsHoldsUpNothingElse) {
  const std::string state = folder_.File("state");
  WriteStorm(folder_.File("anvil.nc"));
  Start({folder_.File("anvil.nc")}, state);
  AwaitReady();
  AwaitOperatorsPort();
  ASSERT_FALSE(HasFatalFailure());
  v1::CreateSessionRequest request;
  *request.mutable_scene() = SceneOf("anvil");
  v1::CreateSessionResponse created;
  ASSERT_TRUE(Call(*stub_, &Stub::CreateSession, request, &created).ok());
  v1::CreateSessionResponse other;
  ASSERT_TRUE(Call(*stub_, &Stub::CreateSession, request, &other).ok());
  HangAt(state);

  const auto refused = [&](const grpc::Status& status) {
    EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr("the state folder " + state));
    EXPECT_EQ(ReasonOf(status), "STORAGE_HANGS");
  };
  v1::CreateSessionResponse third;
  refused(
      AnswerWhereHangs(state, [&] { return Call(*stub_, &Stub::CreateSession, request, &third); }));
  // The program knows by now that the folder hangs, so the next calls do not wait.
  v1::CloseSessionRequest close;
  close.set_session_id(other.session_id());
  v1::CloseSessionResponse closed;
  refused(Call(*stub_, &Stub::CloseSession, close, &closed));
  v1::CreateRenderJobRequest job;
  *job.add_pictures()->mutable_scene() = SceneOf("anvil");
  v1::CreateRenderJobResponse begun;
  refused(Call(*jobs_stub_, &v1::RenderJobService::Stub::CreateRenderJob, job, &begun));

  EXPECT_TRUE(Draw("anvil").ok());
  {
    Interacting viewer(*stub_, created.viewer_key());
    EXPECT_TRUE(viewer.AwaitFrame(created.scene_revision()));
  }
  EXPECT_TRUE(BecomesHealthy("/healthz"));
  EXPECT_THAT(BodyOf(operators_port_, "/readyz"), HasSubstr("the state folder has not answered"));
  EXPECT_THAT(BodyOf(operators_port_, "/metrics"),
              AllOf(ContainsRegex("\nthunderhead_state_stuck_seconds [1-9]"),
                    ContainsRegex("\nthunderhead_readers_abandoned [0-9]+\n")));
  EXPECT_THAT(Contents(err_), ContainsRegex("cannot save sessions.*" + state));
  EXPECT_EQ(CodeAfterSigterm(), 0) << Contents(err_);
}

TEST_F(HungStorageTest, AStateFolderThatHangsFromTheStartSaysSoAndTheProgramEndsWhenItIsTold) {
  const std::string state = folder_.File("state");
  WriteStorm(folder_.File("anvil.nc"));
  HangAt(state);
  Start({folder_.File("anvil.nc")}, state);
  AwaitOperatorsPort();
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_GE(AwaitWarningOf(state), 10.0) << Contents(err_);
  EXPECT_EQ(CodeOf(operators_port_, "/readyz"), 503);
  EXPECT_EQ(CodeAfterSigterm(), 0) << Contents(err_);
}

TEST_F(HungStorageTest, AFileOfTokensThatHangsLocksNobodyOutAndHoldsUpNobody) {
  fs::create_directory(folder_.File("etc"));
  const std::string tokens = folder_.File("etc/tokens");
  // The SHA-256 of kToken.
  std::ofstream(tokens)
      << "anna operator 3eb1bd439947eb762998e566ccc2e099c791118b2f40579cc4f7da2b5061b7f9\n";
  fs::permissions(tokens, fs::perms::owner_read | fs::perms::owner_write);
  WriteStorm(folder_.File("anvil.nc"));
  Start({folder_.File("anvil.nc")}, "none", {"--auth", "tokens", tokens});
  AwaitReady();
  ASSERT_FALSE(HasFatalFailure());
  const auto list = [&](const std::string& token) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kHangLimit);
    context.AddMetadata("authorization", "Bearer " + token);
    v1::ListStormsResponse storms;
    return stub_->ListStorms(&context, {}, &storms).error_code();
  };
  constexpr char kToken[] = "0123456789abcdef0123456789abcdef";
  EXPECT_EQ(list(kToken), grpc::StatusCode::OK);
  const std::string etc = folder_.File("etc");
  HangAt(etc);
  EXPECT_EQ(AnswerWhereHangs(etc, [&] { return list(kToken); }), grpc::StatusCode::OK);
  // The program knows by now that the folder hangs, so the next calls do not wait.
  for (int i = 1; i < 10; ++i) EXPECT_EQ(list(kToken), grpc::StatusCode::OK);
  EXPECT_EQ(list("another"), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_EQ(CodeOf(http_port_, "/healthz"), 200);
  EXPECT_EQ(CodeAfterSigterm(), 0) << Contents(err_);
}

TEST_F(HungStorageTest, ACloudIsNotBegunWhereItsStorageHangs) {
  StartWithClouds();
  ASSERT_FALSE(HasFatalFailure());
  HangAt(folder_.File("clouds"));
  const auto generate = [&] {
    v1::GenerateCloudResponse response;
    return Call(*stub_, &Stub::GenerateCloud, v1::GenerateCloudRequest(), &response);
  };
  const auto refused = [](const grpc::Status& made) {
    EXPECT_EQ(made.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
    EXPECT_THAT(made.error_message(), HasSubstr("its storage does not answer"));
  };
  refused(AnswerWhereHangs(folder_.File("clouds"), generate));
  // The storage is known to hang, so the next call is refused without waiting.
  refused(generate());
  v1::ListStormsResponse storms;
  EXPECT_TRUE(Call(*stub_, &Stub::ListStorms, v1::ListStormsRequest(), &storms).ok());
  EXPECT_EQ(storms.storms_size(), 1);
  EXPECT_EQ(CodeAfterSigterm(), 0) << Contents(err_);
}

TEST_F(HungStorageTest, ACloudThatIsDeletedWhereItsStorageHangsHoldsUpNoList) {
  StartWithClouds();
  ASSERT_FALSE(HasFatalFailure());
  v1::GenerateCloudResponse generated;
  const grpc::Status made =
      Call(*stub_, &Stub::GenerateCloud, v1::GenerateCloudRequest(), &generated);
  ASSERT_TRUE(made.ok()) << made.error_message();
  HangAt(folder_.File("clouds"));
  const auto remove = [&] {
    v1::DeleteCloudRequest request;
    request.set_storm_id(generated.storm().id());
    v1::DeleteCloudResponse response;
    return Call(*stub_, &Stub::DeleteCloud, request, &response);
  };
  const auto refused = [](const grpc::Status& removed) {
    EXPECT_EQ(removed.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
    EXPECT_THAT(removed.error_message(), HasSubstr("its storage does not answer"));
  };
  std::future<grpc::Status> deleting = std::async(std::launch::async, remove);
  ASSERT_TRUE(WaitFor([&] { return Hangs(folder_.File("clouds")); }));
  v1::ListStormsResponse storms;
  EXPECT_TRUE(Call(*stub_, &Stub::ListStorms, v1::ListStormsRequest(), &storms).ok());
  EXPECT_EQ(storms.storms_size(), 2);
  refused(AnswerWhereHangs(folder_.File("clouds"), [&] { return deleting.get(); }));
  // The storage is known to hang, so the next call is refused without waiting.
  refused(remove());
  storms.Clear();
  EXPECT_TRUE(Call(*stub_, &Stub::ListStorms, v1::ListStormsRequest(), &storms).ok());
  EXPECT_EQ(storms.storms_size(), 2) << "the cloud is kept";
  EXPECT_EQ(CodeAfterSigterm(), 0) << Contents(err_);
}

}  // namespace
}  // namespace thunderhead::testing
