// Closes files on threads of its own: closing one may block as reading it does, as on a network
// file system that does not answer. Knows no HTTP.
#pragma once

#include <unistd.h>

#include <functional>

#include "base/executor.h"
#include "base/file_descriptor.h"
#include "base/time_source.h"

namespace thunderhead::gateway {

class FileCloser {
 public:
  // `close` closes a descriptor. `time` must outlive the closer and what it closes.
  explicit FileCloser(std::function<void(int)> close = ::close,
                      const base::TimeSource& time = base::SteadyTime());
  FileCloser(const FileCloser&) = delete;
  FileCloser& operator=(const FileCloser&) = delete;

  // On any thread; does not block. A file stays open where too many wait, and when the closer ends.
  void Close(base::FileDescriptor file);

 private:
  const std::function<void(int)> close_;
  base::Executor threads_;
};

}  // namespace thunderhead::gateway
