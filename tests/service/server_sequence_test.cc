// `thunderhead sequence --server` and `watch --server`: each product once, whoever is killed.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/product_folder.h"
#include "tests/service/running_program.h"
#include "tests/service/synthetic_run.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::testing {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::steady_clock;
using ::testing::HasSubstr;

constexpr int kTimes = 5;
constexpr std::chrono::seconds kLongest{60};

// A port that nobody uses now.
std::string FreePort() {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  bind(socket, reinterpret_cast<sockaddr*>(&address), size);
  getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  close(socket);
  return std::to_string(ntohs(address.sin_port));
}

bool Eventually(const std::function<bool()>& holds) {
  const auto until = steady_clock::now() + kLongest;
  while (!holds() && steady_clock::now() < until) std::this_thread::sleep_for(milliseconds(5));
  return holds();
}

class ServerSequence : public ::testing::Test {
 protected:
  ServerSequence() {
    fs::create_directories(storms_);
    for (int time = 0; time < kTimes; ++time) WriteRunFile(storms_, time);
  }

  std::unique_ptr<RunningProgram> Serve() const {
    fs::remove(served_);
    auto server = std::make_unique<RunningProgram>(
        PROGRAM,
        std::vector<std::string>{"serve", "--data", storms_, "--device", "software", "--http",
                                 "127.0.0.1:0", "--grpc", address_, "--state",
                                 folder_.File("state"), "--settle-seconds", "0.5"},
        served_, folder_.File("server.err"));
    EXPECT_TRUE(Eventually([&] { return Contents(served_).find("ready") != std::string::npos; }))
        << Contents(folder_.File("server.err"));
    return server;
  }

  std::unique_ptr<RunningProgram> Start(const std::string& command, const std::string& storm,
                                        const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {
        command,  storm, "--server",  address_, "--product", out_ + "/{valid:%Y%m%d_%H%M}.png",
        "--size", size_, "--quality", "fast"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<RunningProgram>(PROGRAM, arguments, folder_.File("out.log"),
                                            folder_.File("err.log"));
  }

  std::string Errors() const { return Contents(folder_.File("err.log")); }

  static std::vector<std::string> Products(int times = kTimes) {
    std::vector<std::string> products;
    for (int time = 0; time < times; ++time) products.push_back(RunTime(time) + ".png");
    return products;
  }

  std::size_t Made() const {
    return fs::exists(out_ + "/manifest.jsonl") ? EntriesOf(out_ + "/manifest.jsonl").size() : 0;
  }

  // Results that the server keeps.
  std::size_t Kept() const {
    std::size_t files = 0;
    std::error_code error;
    for (const auto& file :
         fs::recursive_directory_iterator(folder_.File("state") + "/jobs", error)) {
      files += file.path().extension() == ".png" ? 1 : 0;
    }
    return files;
  }

  const TemporaryFolder folder_;
  const std::string storms_ = folder_.File("run");
  const std::string out_ = folder_.File("products");
  const std::string served_ = folder_.File("served");
  std::string size_ = "320x180";
  const std::string address_ = "127.0.0.1:" + FreePort();
};

TEST_F(ServerSequence, MakesEveryProductAndLeavesNothingAtTheServer) {
  const auto server = Serve();
  EXPECT_EQ(Start("sequence", "run")->Wait().code, 0) << Errors();
  ExpectFinished(out_, Products());
  EXPECT_EQ(Kept(), 0U);
  const auto written = fs::last_write_time(out_ + "/" + Products()[0]);
  EXPECT_EQ(Start("sequence", "run")->Wait().code, 0) << Errors();
  EXPECT_EQ(fs::last_write_time(out_ + "/" + Products()[0]), written) << "made twice";
}

TEST_F(ServerSequence, AClientThatIsKilledGoesOnWhereItWas) {
  const auto server = Serve();
  for (std::size_t made = 1; made < kTimes; made += 2) {
    const auto client = Start("sequence", "run");
    ASSERT_TRUE(Eventually([&] { return Made() >= made || !client->Runs(); })) << Errors();
    client->Signal(SIGKILL);
    client->Wait();
  }
  EXPECT_EQ(Start("sequence", "run")->Wait().code, 0) << Errors();
  ExpectFinished(out_, Products());
  EXPECT_EQ(Kept(), 0U);
}

TEST_F(ServerSequence, AServerThatIsKilledIsWaitedForAndGoesOn) {
  auto server = Serve();
  const auto client = Start("sequence", "run");
  ASSERT_TRUE(Eventually([&] { return Made() >= 1; })) << Errors();
  for (std::size_t made = 2; made <= 4; made += 2) {
    server->Signal(SIGKILL);
    server->Wait();
    server = Serve();
    ASSERT_TRUE(Eventually([&] { return Made() >= made; })) << Errors();
  }
  EXPECT_EQ(client->Wait().code, 0) << Errors();
  ExpectFinished(out_, Products());
}

TEST_F(ServerSequence, SaysWhatItEndsFor) {
  EXPECT_EQ(Start("sequence", "run")->Wait().code, 75) << "no server";
  EXPECT_THAT(Errors(), HasSubstr(address_));
  const auto server = Serve();
  EXPECT_EQ(Start("sequence", "nowhere")->Wait().code, 75) << "not there yet";
  EXPECT_THAT(Errors(), HasSubstr("no storm has the id 'nowhere'"));
  EXPECT_EQ(Start("sequence", "run", {"--times", "99"})->Wait().code, 64);
  size_ = "1920x1080";
  const auto client = Start("sequence", "run");
  std::this_thread::sleep_for(milliseconds(700));
  client->Signal(SIGTERM);
  EXPECT_EQ(client->Wait().code, 75) << Errors();
  EXPECT_THAT(Errors(), HasSubstr("the same command goes on"));
}

TEST_F(ServerSequence, WatchesAStormAsItsTimesCome) {
  const auto server = Serve();
  const auto client = Start("watch", "run", {"--until", std::to_string(kTimes + 1)});
  ASSERT_TRUE(Eventually([&] { return Made() >= kTimes; })) << Errors();
  WriteRunFile(storms_, kTimes);
  EXPECT_EQ(client->Wait().code, 0) << Errors();
  ExpectFinished(out_, Products(kTimes + 1));
}

}  // namespace
}  // namespace thunderhead::testing
