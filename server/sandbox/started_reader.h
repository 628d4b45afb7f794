// A confined process that has one storm file open, and answers one request about it after another.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/file_descriptor.h"
#include "base/file_stamp.h"
#include "base/time_source.h"
#include "sandbox/messages.h"

namespace thunderhead::sandbox {

// Asked about each file that was opened by `path`, with the place where it really lies: a link may
// have taken a folder's place since the path was checked. Empty: every place is allowed.
using CheckOpened = std::function<absl::Status(const std::string& path, const std::string& place)>;

// A process of this one; killed, and its end collected, when this object goes.
class Child {
 public:
  Child(pid_t process, const base::TimeSource& time) : process_(process), time_(time) {}
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // 0 once it has ended.
  pid_t Process() const { return process_; }

  // The signal that ended it, 0 if it ended by itself, nothing if it still runs after `patience`.
  std::optional<int> End(std::chrono::milliseconds patience);

 private:
  pid_t process_;
  const base::TimeSource& time_;
};

struct UnmapBytes {
  std::size_t size = 0;
  void operator()(const std::byte* bytes) const;
};

// Memory that a reader fills with arrays and this process reads. It takes no memory before it is
// written.
class SharedArrays {
 public:
  // Without it arrays go through the pipe.
  static SharedArrays Make(std::size_t size);

  // Negative: there are none.
  int File() const { return file_.Get(); }
  std::span<const std::byte> Bytes() const { return {bytes_.get(), bytes_.get_deleter().size}; }

  // Gives back the memory of arrays that are not read any more.
  void Empty();

 private:
  base::FileDescriptor file_;
  std::unique_ptr<const std::byte, UnmapBytes> bytes_;
};

class StartedReader {
 public:
  // Opens the file that `first` names, unless that is a probe, and starts `program` for it with the
  // memory and the processor time of `first`. UNAVAILABLE if no process can be started; errors of a
  // file that cannot be opened, or is none of storms, name it. `time` must outlive the reader.
  static absl::StatusOr<std::unique_ptr<StartedReader>> Start(const std::string& program,
                                                              const Request& first,
                                                              const CheckOpened& check_opened,
                                                              const base::TimeSource& time);

  // True if its file is the one that `path` leads to, and unchanged.
  bool Reads(const std::string& path, const std::optional<base::FileStamp>& now) const {
    return path == path_ && now.has_value() && now == stamp_;
  }

  // Sends the request, which fits into the pipe. A reader that has ended does not notice.
  void Ask(Request request);

  int Replies() const { return replies_.Get(); }
  SharedArrays& Arrays() { return arrays_; }
  Child& Process() { return child_; }
  base::TimeSource::Clock::time_point Began() const { return began_; }

 private:
  StartedReader(std::string path, pid_t process, const base::TimeSource& time)
      : path_(std::move(path)), began_(time.Now()), child_(process, time) {}

  const std::string path_;
  const base::TimeSource::Clock::time_point began_;
  std::optional<base::FileStamp> stamp_;
  SharedArrays arrays_;
  base::FileDescriptor requests_;
  // The other end of `requests_`, which stays open here so that a reader's end is no SIGPIPE.
  base::FileDescriptor requests_from_;
  base::FileDescriptor replies_;
  Child child_;
};

}  // namespace thunderhead::sandbox
