#include "telemetry/watchdog.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <stop_token>
#include <string_view>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "base/file_descriptor.h"

namespace thunderhead::telemetry {
namespace {

constexpr int kMessagesInTime = 3;
constexpr std::string_view kAlive = "WATCHDOG=1";

std::string Variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

// Sends a message. A failure is not reported, because systemd will notice the missing message.
void Send(const std::string& socket_path) {
  const base::FileDescriptor socket(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!socket.IsOpen()) return;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  socket_path.copy(address.sun_path, sizeof(address.sun_path) - 1);
  // A name with "@" is in Linux's abstract socket namespace, where names begin with a zero byte.
  if (address.sun_path[0] == '@') address.sun_path[0] = '\0';
  const auto bytes = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_path.size());
  (void)sendto(socket.Get(), kAlive.data(), kAlive.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
               reinterpret_cast<const sockaddr*>(&address), bytes);
}

}  // namespace

absl::StatusOr<std::unique_ptr<Watchdog>> Watchdog::StartIfAsked(std::function<bool()> alive) {
  const std::string socket = Variable("NOTIFY_SOCKET");
  const std::string within = Variable("WATCHDOG_USEC");
  const std::string pid = Variable("WATCHDOG_PID");
  if (socket.empty() || within.empty()) return nullptr;
  // The variables are meant for another process, probably the parent, which passed them on.
  if (!pid.empty() && pid != absl::StrCat(getpid())) return nullptr;
  std::int64_t within_us = 0;
  if (!absl::SimpleAtoi(within, &within_us) || within_us < kMessagesInTime) {
    return absl::InvalidArgumentError(
        absl::StrCat("WATCHDOG_USEC is '", within, "'; it must be a number of microseconds"));
  }
  if (socket.size() >= sizeof(sockaddr_un::sun_path) || (socket[0] != '/' && socket[0] != '@')) {
    return absl::InvalidArgumentError(
        absl::StrCat("NOTIFY_SOCKET is '", socket, "'; it must be the path of a local socket"));
  }
  return std::unique_ptr<Watchdog>(new Watchdog(
      socket, std::chrono::microseconds(within_us / kMessagesInTime), std::move(alive)));
}

Watchdog::Watchdog(const std::string& socket, std::chrono::microseconds pause,
                   std::function<bool()> alive)
    : thread_([socket, pause, alive = std::move(alive)](const std::stop_token& stop) {
        std::mutex unshared;
        std::unique_lock lock(unshared);
        std::condition_variable_any stopped;
        do {
          if (alive()) Send(socket);
        } while (!stopped.wait_for(lock, stop, pause, [&] { return stop.stop_requested(); }));
      }) {}

}  // namespace thunderhead::telemetry
