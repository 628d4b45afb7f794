// Confined processes that read storm files, watched from here: their time, their end, and what they
// say. However one fails, the outcome is one error that names the file.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/machine_memory.h"
#include "base/time_source.h"
#include "sandbox/archive.h"
#include "sandbox/messages.h"
#include "sandbox/started_reader.h"
#include "storm_files/storm_file.h"

namespace thunderhead::sandbox {

struct ReaderLimits {
  // Of reading, and of what comes of it; 0 if this machine does not say how much it has.
  std::uint64_t memory_bytes = base::MachineMemoryBytes();
  // That this process waits, and processor time.
  std::chrono::milliseconds time{600'000};
  // That nothing comes from a reader that does not wait for its storage.
  std::chrono::milliseconds silence{60'000};
};

// The path of thunderhead-reader, which lies beside this program. INTERNAL if it is not there,
// UNAVAILABLE if another file has replaced it since the first call, because a reader of another
// version may have another layout of messages.
absl::StatusOr<std::string> ReaderProgram();

// Keeps the reader that has answered last for a moment, as most requests about a file come in a
// row: its description, its heights, its times. Safe from any thread.
class RestingReader {
 public:
  explicit RestingReader(const base::TimeSource& time) : time_(time) {}
  ~RestingReader();
  RestingReader(const RestingReader&) = delete;
  RestingReader& operator=(const RestingReader&) = delete;

  // The reader, if it is of the file that the path leads to now; else null.
  std::unique_ptr<StartedReader> Take(const std::string& path);
  // Ends the one that rested until now.
  void Put(std::unique_ptr<StartedReader> reader);

 private:
  void EndInTime();

  const base::TimeSource& time_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::unique_ptr<StartedReader> reader_;
  base::TimeSource::Clock::time_point until_;
  bool ending_ = false;
  std::thread thread_;
};

// Has storm files read by processes of `program`, or of ReaderProgram() if that is empty, and waits
// for them by `time`, which must outlive this. Safe from any thread.
class Readers {
 public:
  // Takes the result after its kind; nothing received fails until the Receiver is asked.
  using Take = std::function<absl::Status(Receiver& from_reader)>;

  explicit Readers(const ReaderLimits& limits, const base::TimeSource& time = base::SteadyTime(),
                   std::string program = "", CheckOpened check_opened = {});

  // Has the file read, within `patience`. `wanted` is the reply that `take` understands; errors of
  // the file come as they are. `checkpoint` may be empty.
  absl::Status Run(Request request, Reply wanted, std::chrono::milliseconds patience,
                   const storm_files::ReadCheckpoint& checkpoint, const Take& take);

 private:
  // Nothing if a reader that had rested has ended without a word.
  std::optional<absl::Status> Ask(std::unique_ptr<StartedReader> reader, bool has_rested,
                                  const Request& request, Reply wanted,
                                  std::chrono::milliseconds patience,
                                  const storm_files::ReadCheckpoint& checkpoint, const Take& take);

  const ReaderLimits limits_;
  const base::TimeSource& time_;
  const std::string program_;
  const CheckOpened check_opened_;
  RestingReader resting_;
};

// True for errors that say that the reader failed and not that the file is none: the file may be
// hostile, so that it should not be tried again at once.
bool IsReaderFailure(const absl::Status& status);

}  // namespace thunderhead::sandbox
