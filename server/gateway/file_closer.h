// Closes files on separate threads. Closing a file can block, for example on a network file system
// that does not respond. Independent of HTTP.
#pragma once

#include <unistd.h>

#include <functional>

#include "base/executor.h"
#include "base/file_descriptor.h"
#include "base/time_source.h"

namespace thunderhead::gateway {

class FileCloser {
 public:
  // `close` closes a file descriptor. `time` must outlive the closer and the files passed to it.
  explicit FileCloser(std::function<void(int)> close = ::close,
                      const base::TimeSource& time = base::SteadyTime());
  FileCloser(const FileCloser&) = delete;
  FileCloser& operator=(const FileCloser&) = delete;

  // Closes a file without blocking. May be called on any thread. The file stays open if too many
  // files are queued, or if the closer ends before it was closed.
  void Close(base::FileDescriptor file);

 private:
  const std::function<void(int)> close_;
  base::Executor threads_;
};

}  // namespace thunderhead::gateway
