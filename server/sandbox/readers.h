// Confined processes that read storm files. They are watched from here: their time, their end, and
// what they send. However a process fails, the result is one error that names the file.
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
  // Memory for reading and for its result. It is 0 if this machine does not report how much it has.
  std::uint64_t memory_bytes = base::MachineMemoryBytes();
  // Timeout of this process' wait, and limit of the reader's processor time.
  std::chrono::milliseconds time{600'000};
  // Timeout for a reader that sends nothing and is not waiting for its storage.
  std::chrono::milliseconds silence{60'000};
};

// Returns the path of thunderhead-reader, which is next to this program. Returns INTERNAL if it is
// missing. Returns UNAVAILABLE if another file has replaced it since the first call, because a
// reader of another version may have another layout of messages.
absl::StatusOr<std::string> ReaderProgram();

// Keeps the reader that has answered last for a moment. Most requests about a file come in a row:
// its description, its heights, its times. Safe from any thread.
class RestingReader {
 public:
  explicit RestingReader(const base::TimeSource& time) : time_(time) {}
  ~RestingReader();
  RestingReader(const RestingReader&) = delete;
  RestingReader& operator=(const RestingReader&) = delete;

  // Returns the reader if it has the file to which the path leads now, else null.
  std::unique_ptr<StartedReader> Take(const std::string& path);
  // Keeps this reader, and ends the one that was kept before.
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

// Reads storm files in processes of `program`, or of ReaderProgram() if that is empty. `time`
// measures the waits for them, and must outlive this. Safe from any thread.
class Readers {
 public:
  // A function that receives the result after the reply's kind. Failures of the Receiver are
  // checked afterwards.
  using Take = std::function<absl::Status(Receiver& from_reader)>;

  explicit Readers(const ReaderLimits& limits, const base::TimeSource& time = base::SteadyTime(),
                   std::string program = "", CheckOpened check_opened = {});

  // Has the file read, within `patience`. `wanted` is the reply that `take` understands. Errors of
  // the file are returned unchanged. `checkpoint` may be empty.
  absl::Status Run(Request request, Reply wanted, std::chrono::milliseconds patience,
                   const storm_files::ReadCheckpoint& checkpoint, const Take& take);

 private:
  // Returns nothing if a reader that was kept has ended without an answer.
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

// Returns whether an error means that the reader failed, and not that the file is invalid. The file
// may be hostile, so it should not be tried again at once.
bool IsReaderFailure(const absl::Status& status);

}  // namespace thunderhead::sandbox
