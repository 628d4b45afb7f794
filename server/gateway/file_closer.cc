#include "gateway/file_closer.h"

#include <chrono>
#include <utility>

namespace thunderhead::gateway {
namespace {

base::Executor::Limits Limits() {
  base::Executor::Limits limits;
  limits.threads = 2;
  limits.hangs_after = std::chrono::seconds(1);
  limits.max_hanging = 16;
  // Files may wait for a long time, because a file that was dropped from the queue would stay open.
  limits.max_wait = std::chrono::hours(24);
  return limits;
}

}  // namespace

FileCloser::FileCloser(std::function<void(int)> close, const base::TimeSource& time)
    : close_(std::move(close)), threads_(Limits(), time) {}

void FileCloser::Close(base::FileDescriptor file) {
  threads_.Submit("", [close = close_, number = file.Release()](const absl::Status& status) {
    if (status.ok()) close(number);
  });
}

}  // namespace thunderhead::gateway
