// A confined process that reads one storm file for one request, watched from here: its time, its
// end, and what it says. However it fails, the outcome is one error that names the file.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/time_source.h"
#include "sandbox/archive.h"
#include "sandbox/messages.h"
#include "volume/storm_file.h"

namespace thunderhead::sandbox {

// The memory of this machine, in bytes.
std::uint64_t MachineMemory();

struct ReaderLimits {
  std::uint64_t memory_bytes = MachineMemory();  // of reading, and of what comes of it
  std::chrono::milliseconds time{600'000};       // that this process waits, and processor time
};

// The path of thunderhead-reader, which lies beside this program. INTERNAL if it is not there,
// UNAVAILABLE if another file has replaced it since the first call, because a reader of another
// version may have another layout of messages.
absl::StatusOr<std::string> ReaderProgram();

// Starts `program`, ReaderProgram() if it is empty, and waits for it by `time`.
class ReaderProcess {
 public:
  // Takes the result after its kind; nothing received fails until the Receiver is asked.
  using Take = std::function<absl::Status(Receiver& from_reader)>;

  // Asked about each file that was opened by `path`, with the place where it really lies: a link
  // may have taken a folder's place since the path was checked. Empty: every place is allowed.
  using CheckOpened =
      std::function<absl::Status(const std::string& path, const std::string& place)>;

  explicit ReaderProcess(const ReaderLimits& limits,
                         const base::TimeSource& time = base::SteadyTime(),
                         std::string program = "", CheckOpened check_opened = {})
      : limits_(limits),
        time_(time),
        program_(std::move(program)),
        check_opened_(std::move(check_opened)) {}

  // Has the file read. `wanted` is the reply that `take` understands; errors of the file come as
  // they are. `checkpoint` may be empty.
  absl::Status Run(Request request, Reply wanted, const volume::ReadCheckpoint& checkpoint,
                   const Take& take) const;

 private:
  const ReaderLimits limits_;
  const base::TimeSource& time_;
  const std::string program_;
  const CheckOpened check_opened_;
};

// True for errors that say that the reader failed and not that the file is none: the file may be
// hostile, so that it should not be tried again at once.
bool IsReaderFailure(const absl::Status& status);

}  // namespace thunderhead::sandbox
