// Tests of `thunderhead sequence --server` and `watch --server`: each product is drawn once,
// whichever process is killed.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pipeline/sha256.h"
#include "tests/service/hanging_storage.h"
#include "tests/service/product_folder.h"
#include "tests/service/running_program.h"
#include "tests/service/synthetic_run.h"
#include "tests/support/own_host.h"
#include "tests/support/self_signed.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kSequenceTimes = 5;

class ServerSequence : public ::testing::Test {
 protected:
  ServerSequence() {
    fs::create_directories(storms_);
    for (int time = 0; time < kSequenceTimes; ++time) WriteRunFile(storms_, time);
  }

  // Starts the server, at `address_` if it had one before, and waits until it is ready. All
  // existing files count as complete.
  std::unique_ptr<RunningProgram> Serve(const std::vector<std::string>& more = {}) {
    fs::remove(served_);
    WaitFor([this] {
      const std::string last = RunFile(storms_, kSequenceTimes - 1);
      const auto age = fs::file_time_type::clock::now() - fs::last_write_time(last);
      return age > std::chrono::milliseconds(200);
    });
    std::vector<std::string> arguments = {"serve",
                                          "--data",
                                          storms_,
                                          "--device",
                                          "software",
                                          "--http",
                                          "127.0.0.1:0",
                                          "--grpc",
                                          address_,
                                          "--state",
                                          folder_.File("state"),
                                          "--settle-seconds",
                                          "0.1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    auto server =
        std::make_unique<RunningProgram>(PROGRAM, arguments, served_, folder_.File("server.err"));
    std::smatch ready;
    std::string said;
    EXPECT_TRUE(WaitFor([&] {
      said = Contents(served_);
      return std::regex_search(said, ready, std::regex("\\(gRPC ([0-9.:]+)\\)")) || !server->Runs();
    }));
    EXPECT_FALSE(ready.empty()) << Contents(folder_.File("server.err"));
    if (!ready.empty()) address_ = ready[1];
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

  // Starts a client that hangs when it opens the file `path`.
  std::unique_ptr<RunningProgram> StartHeldAt(const std::string& path) const {
    HangAt(path);
    const HangingStorage hanging;
    return Start("sequence", "run");
  }

  std::string Errors() const { return Contents(folder_.File("err.log")); }

  static std::vector<std::string> Products(int times = kSequenceTimes) {
    std::vector<std::string> products;
    for (int time = 0; time < times; ++time) products.push_back(RunTime(time) + ".png");
    return products;
  }

  std::size_t Made() const {
    return fs::exists(out_ + "/manifest.jsonl") ? EntriesOf(out_ + "/manifest.jsonl").size() : 0;
  }

  // Returns the number of drawn results that the server still stores.
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
  std::string address_ = OwnHost() + ":0";
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
  for (std::size_t made = 1; made < kSequenceTimes; made += 2) {
    const auto client = Start("sequence", "run");
    ASSERT_TRUE(WaitFor([&] { return Made() >= made || !client->Runs(); })) << Errors();
    client->Signal(SIGKILL);
    client->Wait();
  }
  EXPECT_EQ(Start("sequence", "run")->Wait().code, 0) << Errors();
  ExpectFinished(out_, Products());
  EXPECT_EQ(Kept(), 0U);
}

TEST_F(ServerSequence, AJobThatAKilledClientLeftIsForgottenThoughNothingIsMissing) {
  if (!kHasHangingStorage) GTEST_SKIP() << "a sanitizer must be the program's first library";
  const auto server = Serve();
  ASSERT_EQ(Start("sequence", "run")->Wait().code, 0) << Errors();
  const std::string aside = folder_.File("aside");
  fs::create_directory(aside);
  for (const std::string& product : Products()) {
    fs::rename(out_ + "/" + product, aside + "/" + product);
  }
  // Holds the client at its first product, so that results remain at the server.
  const std::string held = out_ + "/" + Products()[0] + ".partial";
  const auto client = StartHeldAt(held);
  ASSERT_TRUE(WaitFor([&] { return Kept() >= 1 || !client->Runs(); }));
  ASSERT_TRUE(client->Runs()) << Errors();
  client->Signal(SIGKILL);
  client->Wait();
  HangNoLonger(held);
  for (const std::string& product : Products()) {
    if (fs::exists(out_ + "/" + product)) continue;
    fs::rename(aside + "/" + product, out_ + "/" + product);
  }
  ASSERT_TRUE(WaitFor([&] { return Kept() >= 1; }));
  EXPECT_EQ(Start("sequence", "run")->Wait().code, 0) << Errors();
  EXPECT_EQ(Kept(), 0U);
}

TEST_F(ServerSequence, AServerThatIsKilledIsWaitedForAndGoesOn) {
  auto server = Serve();
  const auto client = Start("sequence", "run");
  ASSERT_TRUE(WaitFor([&] { return Made() >= 1 || !client->Runs(); })) << Errors();
  for (std::size_t made = 2; made <= 4; made += 2) {
    server->Signal(SIGKILL);
    server->Wait();
    server = Serve();
    ASSERT_TRUE(WaitFor([&] { return Made() >= made || !client->Runs(); })) << Errors();
  }
  EXPECT_EQ(client->Wait().code, 0) << Errors();
  ExpectFinished(out_, Products());
}

TEST_F(ServerSequence, SaysWhatItEndsFor) {
  address_ = OwnHost() + ":1";
  EXPECT_EQ(Start("sequence", "run")->Wait().code, 75) << "no server";
  EXPECT_THAT(Errors(), HasSubstr(address_));
  address_ = OwnHost() + ":0";
  const auto server = Serve();
  EXPECT_EQ(Start("sequence", "nowhere")->Wait().code, 75) << "not there yet";
  EXPECT_THAT(Errors(), HasSubstr("no storm has the id 'nowhere'"));
  EXPECT_EQ(Start("sequence", "run", {"--times", "99"})->Wait().code, 64);
}

TEST_F(ServerSequence, SaysHowToContinueAfterASignal) {
  if (!kHasHangingStorage) GTEST_SKIP() << "a sanitizer must be the program's first library";
  const auto server = Serve();
  // Holds the client at a product, so that it cannot end before the signal arrives.
  const std::string held = out_ + "/" + Products()[0] + ".partial";
  fs::create_directories(out_);
  const auto client = StartHeldAt(held);
  ASSERT_TRUE(WaitFor([&] { return Kept() >= 1 || !client->Runs(); }));
  client->Signal(SIGTERM);
  EXPECT_TRUE(WaitFor([&] { return client->IsInterrupted() || !client->Runs(); }));
  HangNoLonger(held);
  EXPECT_EQ(client->Wait().code, 75) << Errors();
  EXPECT_THAT(Errors(), HasSubstr("run the same command again to continue"));
}

// Runs as an office would: TLS, a token with the pipeline role, shares in two views, and their
// movie.
TEST_F(ServerSequence, AServerWithTokensAndTlsServesSharesViewsAndMovies) {
  const std::string token = folder_.File("token");
  std::ofstream(token) << "a-token-of-32-letters-or-more-01\n";
  const std::string other = folder_.File("other");
  std::ofstream(other) << "another-token-that-nobody-gave-0\n";
  const std::string tokens = folder_.File("tokens");
  std::ofstream(tokens) << "suite pipeline " << pipeline::Sha256("a-token-of-32-letters-or-more-01")
                        << "\n";
  fs::permissions(tokens, fs::perms::owner_read | fs::perms::owner_write);
  const std::string certificate = folder_.File("cert.pem");
  const std::string key = folder_.File("key.pem");
  WriteSelfSigned(certificate, key, 1);
  fs::permissions(key, fs::perms::owner_read | fs::perms::owner_write);
  // The certificate is for localhost.
  address_ = "127.0.0.1:0";
  const auto server =
      Serve({"--auth", "tokens", tokens, "--tls-cert", certificate, "--tls-key", key});
  const std::string west = folder_.File("west.json");
  const std::string above = folder_.File("above.json");
  std::ofstream(west) << R"({"camera": {"orbit": {"azimuthDeg": 270}}})";
  std::ofstream(above) << R"({"camera": {"topDown": {}}})";
  size_ = "64x36";
  const std::string host = "localhost" + address_.substr(address_.find(':'));
  const auto start = [&](const std::string& command, const std::vector<std::string>& more,
                         const std::string& by) {
    std::vector<std::string> arguments = {
        "--server",     host,        "--tls-ca",
        certificate,    "--views",   west,
        above,          "--product", out_ + "/{valid:%H%M}_{view}.png",
        "--token-file", by};
    arguments.insert(arguments.end(), more.begin(), more.end());
    std::vector<std::string> words = {command, "run", "--size", size_, "--quality", "fast"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return std::make_unique<RunningProgram>(PROGRAM, words, folder_.File("out.log"),
                                            folder_.File("err.log"));
  };
  EXPECT_EQ(start("sequence", {}, other)->Wait().code, 78) << Errors();
  const auto first = start("sequence", {"--shard", "0/2"}, token);
  const auto second = start("sequence", {"--shard", "1/2"}, token);
  EXPECT_EQ(first->Wait().code, 0) << Errors();
  EXPECT_EQ(second->Wait().code, 0) << Errors();
  EXPECT_EQ(EntriesOf(out_ + "/manifest.0-of-2.jsonl").size(), 6U);
  EXPECT_EQ(EntriesOf(out_ + "/manifest.1-of-2.jsonl").size(), 4U);
  const std::vector<std::string> movie = {"--movie", out_ + "/{view}.webm"};
  EXPECT_EQ(start("sequence", movie, token)->Wait().code, 0) << Errors();
  std::vector<std::string> products = {"west.webm", "above.webm"};
  for (int time = 0; time < kSequenceTimes; ++time) {
    for (const char* view : {"west", "above"}) {
      products.push_back(RunTime(time).substr(9) + "_" + view + ".png");
    }
  }
  ExpectFinished(out_, products);
  // With the same flags, `watch` finds that all products exist, and `render` draws one more
  // picture.
  std::vector<std::string> until = movie;
  until.insert(until.end(), {"--until", std::to_string(kSequenceTimes)});
  EXPECT_EQ(start("watch", until, token)->Wait().code, 0) << Errors();
  ExpectFinished(out_, products);
  const std::string one = folder_.File("one.png");
  for (const std::string& by : {token, other}) {
    const int code =
        RunningProgram(PROGRAM,
                       {"render", "run", "--server", host, "--tls-ca", certificate, "--token-file",
                        by, "--size", size_, "--quality", "fast", "-o", one},
                       folder_.File("out.log"), folder_.File("err.log"))
            .Wait()
            .code;
    EXPECT_EQ(code, by == token ? 0 : 78) << Errors();
  }
  EXPECT_TRUE(fs::exists(one));
}

TEST_F(ServerSequence, WatchesAStormAsItsTimesCome) {
  const auto server = Serve();
  const auto client = Start("watch", "run", {"--until", std::to_string(kSequenceTimes + 1)});
  ASSERT_TRUE(WaitFor([&] { return Made() >= kSequenceTimes || !client->Runs(); })) << Errors();
  // The file is moved into place complete.
  const std::string aside = folder_.File("aside");
  fs::create_directory(aside);
  WriteRunFile(aside, kSequenceTimes);
  fs::rename(RunFile(aside, kSequenceTimes), RunFile(storms_, kSequenceTimes));
  EXPECT_EQ(client->Wait().code, 0) << Errors();
  ExpectFinished(out_, Products(kSequenceTimes + 1));
}

}  // namespace
}  // namespace thunderhead::testing
