#include "rpc_port/local_listener.h"

#include <grpcpp/server_posix.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/file_descriptor.h"
#include "base/line_limit.h"
#include "base/status.h"
#include "spdlog/spdlog.h"

namespace thunderhead::rpc_port {
namespace {

// Returns a name in Linux's abstract namespace, which needs no file and disappears with the
// process.
std::string NewName() {
  static std::atomic<int> count{0};
  return absl::StrCat("thunderhead-", getpid(), "-", ++count);
}

bool Bind(int socket, const std::string& name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  // The first byte of an abstract name is 0.
  name.copy(address.sun_path + 1, sizeof(address.sun_path) - 1);
  const auto bytes = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return bind(socket, reinterpret_cast<const sockaddr*>(&address), bytes) == 0;
}

// Maximum number of warnings per second. Any user of this machine may try to connect, at any rate.
constexpr int kMaxWarningsPerSecond = 5;

// Returns true if the connecting process belongs to the same user as this process. Root is refused
// too, because it has no need to connect.
bool IsOwnUser(int connection, base::LineLimit& warnings) {
  ucred peer{};
  socklen_t bytes = sizeof(peer);
  const bool known = getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &bytes) == 0;
  if (known && peer.uid == geteuid()) return true;
  if (const auto left_out = warnings.Take(std::chrono::system_clock::now())) {
    spdlog::warn("refusing process {} of user {} at the local socket{}", peer.pid, peer.uid,
                 *left_out == 0 ? "" : absl::StrCat(" (", *left_out, " more since the last line)"));
  }
  return false;
}

}  // namespace

absl::StatusOr<std::unique_ptr<LocalListener>> LocalListener::Start(grpc::Server& server) {
  const std::string name = NewName();
  base::FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket.IsOpen() || !Bind(socket.Get(), name) || listen(socket.Get(), SOMAXCONN) != 0) {
    return absl::UnavailableError(
        absl::StrCat("cannot listen on a local socket: ", strerror(errno)));
  }
  std::vector<base::FileDescriptor> sockets;
  sockets.push_back(std::move(socket));
  const auto take = [&server, warnings = std::make_shared<base::LineLimit>(kMaxWarningsPerSecond)](
                        base::FileDescriptor connection) {
    if (!IsOwnUser(connection.Get(), *warnings)) return;
    grpc::AddInsecureChannelFromFd(&server, connection.Release());
  };
  THUNDERHEAD_ASSIGN_OR_RETURN(auto loop, AcceptLoop::Start(std::move(sockets), take));
  return std::unique_ptr<LocalListener>(
      new LocalListener(absl::StrCat("unix-abstract:", name), std::move(loop)));
}

}  // namespace thunderhead::rpc_port
