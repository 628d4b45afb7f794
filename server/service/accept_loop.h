// Accepts connections on sockets that listen, on a thread of its own.
#pragma once

#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "absl/status/statusor.h"
#include "base/file_descriptor.h"

namespace thunderhead::service {

class AcceptLoop {
 public:
  // Takes over `connection`, which does not block; on the loop's thread.
  using Take = std::function<void(base::FileDescriptor connection)>;

  // Accepts until it is destroyed. `sockets` listen and do not block.
  static absl::StatusOr<std::unique_ptr<AcceptLoop>> Start(
      std::vector<base::FileDescriptor> sockets, Take take);
  ~AcceptLoop();
  AcceptLoop(const AcceptLoop&) = delete;
  AcceptLoop& operator=(const AcceptLoop&) = delete;

 private:
  AcceptLoop(std::vector<base::FileDescriptor> sockets, base::FileDescriptor stop, Take take)
      : sockets_(std::move(sockets)), stop_(std::move(stop)), take_(std::move(take)) {}
  void Run();

  const std::vector<base::FileDescriptor> sockets_;
  const base::FileDescriptor stop_;  // an eventfd
  const Take take_;
  std::thread thread_;
};

}  // namespace thunderhead::service
