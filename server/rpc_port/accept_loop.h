// Accepts connections on listening sockets, on a separate thread.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "absl/status/statusor.h"
#include "base/file_descriptor.h"
#include "base/time_source.h"

namespace thunderhead::rpc_port {

class AcceptLoop {
 public:
  // Takes ownership of `connection`, whose socket is non-blocking. It is called on the loop's
  // thread.
  using Take = std::function<void(base::FileDescriptor connection)>;

  // An additional task of the loop's thread. It runs once every `pause`, and whenever the
  // descriptor `signal` is readable, which the task must then read. `time` measures the pause.
  // `time` and `signal` must outlive the loop.
  struct Chore {
    std::chrono::milliseconds pause;
    std::function<void()> run;
    const base::TimeSource* time = &base::SteadyTime();
    int signal = -1;  // -1: none
  };

  // Starts a loop that accepts until it is destroyed. `sockets` must be listening and non-blocking.
  // Returns UNAVAILABLE without a free file descriptor.
  static absl::StatusOr<std::unique_ptr<AcceptLoop>> Start(
      std::vector<base::FileDescriptor> sockets, Take take,
      std::optional<Chore> chore = std::nullopt);
  ~AcceptLoop();
  AcceptLoop(const AcceptLoop&) = delete;
  AcceptLoop& operator=(const AcceptLoop&) = delete;

 private:
  AcceptLoop(std::vector<base::FileDescriptor> sockets, base::FileDescriptor stop, Take take,
             std::optional<Chore> chore)
      : sockets_(std::move(sockets)),
        stop_(std::move(stop)),
        take_(std::move(take)),
        chore_(std::move(chore)) {}
  // Runs the chore if it is due, and returns the timeout for poll in milliseconds.
  int DoChore();
  void Run();

  const std::vector<base::FileDescriptor> sockets_;
  const base::FileDescriptor stop_;  // an eventfd
  const Take take_;
  const std::optional<Chore> chore_;
  base::TimeSource::Clock::time_point chore_due_{};
  std::thread thread_;
};

}  // namespace thunderhead::rpc_port
