// A confined process that has opened one storm file, and answers requests about this file one after
// another.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/file_descriptor.h"
#include "base/file_stamp.h"
#include "base/time_source.h"
#include "sandbox/child.h"
#include "sandbox/messages.h"

namespace thunderhead::sandbox {

// A function that decides whether an opened file may be read. `path` is the path by which it was
// opened, and `place` its real path. The check is necessary because a link may have replaced a
// folder since the path was checked. If the function is empty, every file may be read.
using CheckOpened = std::function<absl::Status(const std::string& path, const std::string& place)>;

// A function that checks the start of an opened file before a process is started to read it.
using CheckStart = std::function<absl::Status(const std::string& path, int file)>;

// Returns an error if the first bytes of a file belong to no format of storm files.
absl::Status CheckStormStart(const std::string& path, int file);

// The checks of an opened file.
struct FileChecks {
  CheckOpened opened = {};
  CheckStart start = CheckStormStart;
};

struct UnmapBytes {
  std::size_t size = 0;
  void operator()(const std::byte* bytes) const;
};

// Memory that a reader fills with arrays and this process reads. The kernel allocates its pages
// only when they are written.
class SharedArrays {
 public:
  // Creates `size` bytes of shared memory. If that fails, the result is empty and arrays go through
  // the pipe.
  static SharedArrays Make(std::size_t size);

  // Returns the descriptor of the memory, or a negative number if there is no memory.
  int File() const { return file_.Get(); }
  std::span<const std::byte> Bytes() const { return {bytes_.get(), bytes_.get_deleter().size}; }

  // Frees the memory of all arrays. Their content is lost.
  void Empty();

 private:
  base::FileDescriptor file_;
  std::unique_ptr<const std::byte, UnmapBytes> bytes_;
};

class StartedReader {
 public:
  // Opens the file or the bundled files that `first` names, unless `first` is a probe. Then starts
  // `program` for them, with the limits of memory and processor time in `first`. Returns
  // UNAVAILABLE if no process can be started, also because too many earlier ones were abandoned
  // (ChildPlace). If a file cannot be opened or fails a check, the error names the file. `time`
  // must outlive the reader.
  static absl::StatusOr<std::unique_ptr<StartedReader>> Start(const std::string& program,
                                                              const Request& first,
                                                              const FileChecks& checks,
                                                              const base::TimeSource& time);

  // Returns whether the reader's file was opened by `path`, or its files by `bundled`, and whether
  // all of them still have the identity, size and times (stamp) that they had.
  bool Reads(const std::string& path, const std::vector<std::string>& bundled) const;

  // Sends the request without blocking, because it fits into the pipe. Does not report an error if
  // the reader has ended.
  void Ask(Request request);

  int Replies() const { return replies_.Get(); }
  SharedArrays& Arrays() { return arrays_; }
  Child& Process() { return child_; }
  base::TimeSource::Clock::time_point Began() const { return began_; }

 private:
  StartedReader(std::string path, pid_t process, ChildPlace place, const base::TimeSource& time)
      : path_(std::move(path)), began_(time.Now()), child_(process, std::move(place), time) {}

  const std::string path_;
  const base::TimeSource::Clock::time_point began_;
  std::vector<std::string> bundled_;
  std::vector<base::FileStamp> stamps_;  // of the file, or of each bundled file
  SharedArrays arrays_;
  base::FileDescriptor requests_;
  // The other end of `requests_`. It stays open here so that a request to a reader that has exited
  // causes no SIGPIPE.
  base::FileDescriptor requests_from_;
  base::FileDescriptor replies_;
  Child child_;
};

}  // namespace thunderhead::sandbox
