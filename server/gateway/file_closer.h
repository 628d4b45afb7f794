// Closes files on separate threads. Closing a file can block just as reading can, for example on a
// network file system that does not respond. It is independent of HTTP.
#pragma once

#include <unistd.h>

#include <functional>

#include "base/executor.h"
#include "base/file_descriptor.h"
#include "base/time_source.h"

namespace thunderhead::gateway {

class FileCloser {
 public:
  // `close` closes a descriptor. `time` must outlive the closer and the files passed to it.
  explicit FileCloser(std::function<void(int)> close = ::close,
                      const base::TimeSource& time = base::SteadyTime());
  FileCloser(const FileCloser&) = delete;
  FileCloser& operator=(const FileCloser&) = delete;

  // Closes a file without blocking; it may be called on any thread. A file stays open if too many
  // are queued, and when the closer ends.
  void Close(base::FileDescriptor file);

 private:
  const std::function<void(int)> close_;
  base::Executor threads_;
};

}  // namespace thunderhead::gateway
