#include "telemetry/watchdog.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <string>

#include "absl/strings/str_cat.h"
#include "base/file_descriptor.h"
#include "gtest/gtest.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::telemetry {
namespace {

using testing::WaitFor;

// A fixture with the socket that systemd listens on.
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

  // Returns the next message if it has arrived; empty if none has.
  std::string Come() {
    std::string message(64, '\0');
    const ssize_t bytes = recv(socket_.Get(), message.data(), message.size(), MSG_DONTWAIT);
    message.resize(bytes < 0 ? 0 : static_cast<std::size_t>(bytes));
    return message;
  }
  // Waits for the next message and returns it.
  std::string Next() {
    std::string message;
    WaitFor([&] { return !(message = Come()).empty(); });
    return message;
  }

 private:
  const testing::TemporaryFolder folder_;
  const base::FileDescriptor socket_;
};

TEST_F(WatchdogTest, IsToldAsLongAsThereIsProgress) {
  std::atomic<bool> alive{true};
  std::atomic<int> denied{0};
  const auto watchdog = Watchdog::StartIfAsked([&] {
    if (!alive) ++denied;
    return alive.load();
  });
  ASSERT_TRUE(watchdog.ok() && *watchdog != nullptr) << watchdog.status();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(Next(), "WATCHDOG=1");
  alive = false;
  // All messages sent before have arrived by now.
  ASSERT_TRUE(WaitFor([&] { return denied >= 2; }));
  while (!Come().empty()) {
  }
  ASSERT_TRUE(WaitFor([&] { return denied >= 6; }));
  EXPECT_EQ(Come(), "");
  alive = true;
  EXPECT_EQ(Next(), "WATCHDOG=1");
}

TEST_F(WatchdogTest, NobodyIsToldWhoDidNotAsk) {
  const auto alive = [] { return true; };
  Set("WATCHDOG_PID", absl::StrCat(getpid() + 1));
  EXPECT_EQ(*Watchdog::StartIfAsked(alive), nullptr);
  unsetenv("WATCHDOG_USEC");
  EXPECT_EQ(*Watchdog::StartIfAsked(alive), nullptr);
  EXPECT_EQ(Come(), "");
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
