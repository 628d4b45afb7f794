#include "service/local_listener.h"

#include <fcntl.h>
#include <grpcpp/server_posix.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "spdlog/spdlog.h"

namespace thunderhead::service {
namespace {

// After an error, as when there are no file descriptors left.
constexpr std::chrono::milliseconds kPause{100};

// In Linux's abstract namespace, which needs no file and disappears with the process.
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

// True for a process of this process' user. Root may do anything anyway, but has no need to.
bool IsOwnUser(int connection) {
  ucred peer{};
  socklen_t bytes = sizeof(peer);
  const bool known = getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &bytes) == 0;
  if (known && peer.uid == geteuid()) return true;
  spdlog::warn("refusing process {} of user {} at the local socket", peer.pid, peer.uid);
  return false;
}

}  // namespace

absl::StatusOr<std::unique_ptr<LocalListener>> LocalListener::Start(grpc::Server& server) {
  const std::string name = NewName();
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int stop = eventfd(0, EFD_CLOEXEC);
  std::unique_ptr<LocalListener> listener(
      new LocalListener(server, absl::StrCat("unix-abstract:", name), socket, stop));
  if (socket < 0 || stop < 0 || !Bind(socket, name) || listen(socket, SOMAXCONN) != 0) {
    return absl::UnavailableError(
        absl::StrCat("cannot listen on a local socket: ", strerror(errno)));
  }
  listener->thread_ = std::thread([&listener = *listener] { listener.Accept(); });
  return listener;
}

LocalListener::~LocalListener() {
  if (thread_.joinable()) {
    const std::uint64_t one = 1;
    (void)!write(stop_, &one, sizeof(one));
    thread_.join();
  }
  if (socket_ >= 0) close(socket_);
  if (stop_ >= 0) close(stop_);
}

void LocalListener::Accept() {
  while (true) {
    pollfd waits[] = {{socket_, POLLIN, 0}, {stop_, POLLIN, 0}};
    if (poll(waits, 2, -1) < 0 && errno != EINTR) return;
    if (waits[1].revents != 0) return;
    // gRPC wants sockets that do not block.
    const int connection = accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (connection < 0) {
      if (errno != EAGAIN && errno != ECONNABORTED) std::this_thread::sleep_for(kPause);
      continue;
    }
    if (IsOwnUser(connection)) {
      grpc::AddInsecureChannelFromFd(&server_, connection);
    } else {
      close(connection);
    }
  }
}

}  // namespace thunderhead::service
