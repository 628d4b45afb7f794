#include "rpc_port/accept_loop.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace thunderhead::rpc_port {
namespace {

// Pause after a failed accept, for example when no file descriptors are left.
constexpr std::chrono::milliseconds kPause{100};

}  // namespace

absl::StatusOr<std::unique_ptr<AcceptLoop>> AcceptLoop::Start(
    std::vector<base::FileDescriptor> sockets, Take take, std::optional<Chore> chore) {
  base::FileDescriptor stop(eventfd(0, EFD_CLOEXEC));
  if (!stop.IsOpen()) {
    return absl::UnavailableError(absl::StrCat("cannot accept connections: ", strerror(errno)));
  }
  std::unique_ptr<AcceptLoop> loop(
      new AcceptLoop(std::move(sockets), std::move(stop), std::move(take), std::move(chore)));
  loop->thread_ = std::thread([&loop = *loop] { loop.Run(); });
  return loop;
}

AcceptLoop::~AcceptLoop() {
  const std::uint64_t one = 1;
  (void)!write(stop_.Get(), &one, sizeof(one));
  if (thread_.joinable()) thread_.join();
}

int AcceptLoop::DoChore() {
  if (!chore_.has_value()) return -1;
  const base::TimeSource& time = *chore_->time;
  if (const auto now = time.Now(); now >= chore_due_) {
    chore_due_ = now + chore_->pause;
    chore_->run();
  }
  const auto wait = std::chrono::ceil<std::chrono::milliseconds>(time.LookAgainAt(chore_due_) -
                                                                 base::TimeSource::Clock::now());
  constexpr std::int64_t kLongestWait_ms = 60'000;
  return static_cast<int>(std::clamp<std::int64_t>(wait.count(), 0, kLongestWait_ms));
}

void AcceptLoop::Run() {
  const int signal = chore_.has_value() ? chore_->signal : -1;  // poll ignores -1
  std::vector<pollfd> waits = {{stop_.Get(), POLLIN, 0}, {signal, POLLIN, 0}};
  constexpr std::size_t kFirstSocket = 2;
  for (const base::FileDescriptor& socket : sockets_) waits.push_back({socket.Get(), POLLIN, 0});
  if (chore_.has_value()) chore_due_ = chore_->time->Now() + chore_->pause;
  while (true) {
    if (poll(waits.data(), waits.size(), DoChore()) < 0 && errno != EINTR) return;
    if (waits[0].revents != 0) return;
    if (waits[1].revents != 0) chore_->run();
    for (std::size_t i = kFirstSocket; i < waits.size(); ++i) {
      if (waits[i].revents == 0) continue;
      base::FileDescriptor connection(
          accept4(waits[i].fd, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
      if (connection.IsOpen()) {
        take_(std::move(connection));
      } else if (errno != EAGAIN && errno != ECONNABORTED) {
        std::this_thread::sleep_for(kPause);
      }
    }
  }
}

}  // namespace thunderhead::rpc_port
