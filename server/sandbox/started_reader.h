// A confined process that has one storm file open, and answers requests about it one after another.
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

// A check that is called for each file that was opened by `path`, with the place where it really
// is. A link may have replaced a folder since the path was checked. If empty, every place is
// allowed.
using CheckOpened = std::function<absl::Status(const std::string& path, const std::string& place)>;

// A child process. The destructor kills it and collects its exit status.
class Child {
 public:
  Child(pid_t process, const base::TimeSource& time) : process_(process), time_(time) {}
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Returns 0 once the process has ended.
  pid_t Process() const { return process_; }

  // Returns the signal that ended the process, or 0 if it exited normally. Returns nothing if it
  // still runs after `patience`.
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
  // Creates the memory. If that fails, arrays go through the pipe.
  static SharedArrays Make(std::size_t size);

  // Returns a negative number if there is no memory.
  int File() const { return file_.Get(); }
  std::span<const std::byte> Bytes() const { return {bytes_.get(), bytes_.get_deleter().size}; }

  // Frees the memory of arrays that are no longer read.
  void Empty();

 private:
  base::FileDescriptor file_;
  std::unique_ptr<const std::byte, UnmapBytes> bytes_;
};

class StartedReader {
 public:
  // Opens the file that `first` names, unless it is a probe. Then starts `program` for the file,
  // with the memory and the processor time of `first`. Returns UNAVAILABLE if no process can be
  // started. Errors of a file that cannot be opened, or that is not a storm file, name it. `time`
  // must outlive the reader.
  static absl::StatusOr<std::unique_ptr<StartedReader>> Start(const std::string& program,
                                                              const Request& first,
                                                              const CheckOpened& check_opened,
                                                              const base::TimeSource& time);

  // Returns whether its file is the one to which `path` leads, and unchanged.
  bool Reads(const std::string& path, const std::optional<base::FileStamp>& now) const {
    return path == path_ && now.has_value() && now == stamp_;
  }

  // Sends the request, which fits into the pipe. Does not detect that a reader has ended.
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
  // The other end of `requests_`. It stays open here so that a reader's end causes no SIGPIPE.
  base::FileDescriptor requests_from_;
  base::FileDescriptor replies_;
  Child child_;
};

}  // namespace thunderhead::sandbox
