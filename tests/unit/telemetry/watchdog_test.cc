#include "telemetry/watchdog.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <string>

#include "absl/strings/str_cat.h"
#include "base/file_descriptor.h"
#include "gtest/gtest.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::telemetry {
namespace {

// The socket that systemd listens on.
class WatchdogTest : public ::testing::Test {
 protected:
  WatchdogTest() : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const std::string path = folder_.File("notify");
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof(address.sun_path) - 1);
    EXPECT_EQ(bind(socket_.Get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    Set("NOTIFY_SOCKET", path);
    Set("WATCHDOG_USEC", "60000");
    Set("WATCHDOG_PID", absl::StrCat(getpid()));
  }
  ~WatchdogTest() override {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
  }

  static void Set(const char* name, const std::string& value) { setenv(name, value.c_str(), 1); }

  // The next message; empty if none comes within that time.
  std::string Next(std::chrono::milliseconds within) {
    const timeval wait{within.count() / 1000, 1000 * (within.count() % 1000)};
    setsockopt(socket_.Get(), SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof(wait));
    std::string message(64, '\0');
    const ssize_t bytes = recv(socket_.Get(), message.data(), message.size(), 0);
    message.resize(bytes < 0 ? 0 : static_cast<std::size_t>(bytes));
    return message;
  }

 private:
  const testing::TemporaryFolder folder_;
  const base::FileDescriptor socket_;
};

constexpr std::chrono::milliseconds kPatience{10'000};
// Several times WATCHDOG_USEC.
constexpr std::chrono::milliseconds kSilence{300};

TEST_F(WatchdogTest, IsToldAsLongAsThereIsProgress) {
  std::atomic<bool> alive{true};
  const auto watchdog = Watchdog::StartIfAsked([&alive] { return alive.load(); });
  ASSERT_TRUE(watchdog.ok() && *watchdog != nullptr) << watchdog.status();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(Next(kPatience), "WATCHDOG=1");
  alive = false;
  // Some may be on their way.
  for (int i = 0; i < 20 && !Next(kSilence).empty(); ++i) {
  }
  EXPECT_EQ(Next(kSilence), "");
  alive = true;
  EXPECT_EQ(Next(kPatience), "WATCHDOG=1");
}

TEST_F(WatchdogTest, NobodyIsToldWhoDidNotAsk) {
  const auto alive = [] { return true; };
  Set("WATCHDOG_PID", absl::StrCat(getpid() + 1));
  EXPECT_EQ(*Watchdog::StartIfAsked(alive), nullptr);
  unsetenv("WATCHDOG_USEC");
  EXPECT_EQ(*Watchdog::StartIfAsked(alive), nullptr);
  EXPECT_EQ(Next(kSilence), "");
}

TEST_F(WatchdogTest, AnEnvironmentThatMakesNoSenseIsNamed) {
  const auto alive = [] { return true; };
  Set("WATCHDOG_USEC", "soon");
  EXPECT_TRUE(absl::IsInvalidArgument(Watchdog::StartIfAsked(alive).status()));
  Set("WATCHDOG_USEC", "60000");
  Set("NOTIFY_SOCKET", "relative");
  EXPECT_TRUE(absl::IsInvalidArgument(Watchdog::StartIfAsked(alive).status()));
}

}  // namespace
}  // namespace thunderhead::telemetry
