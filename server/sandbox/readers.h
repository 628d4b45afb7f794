// Starts confined processes (readers) that read storm files, and watches their time, their exit and
// the data that they send. If a reader fails in any way, the result is one error that names the
// file.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
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
  // The memory in bytes that a reader may use for reading and for the result. 0 means no limit. It
  // is the default on a machine whose memory size is unknown.
  std::uint64_t memory_bytes = base::MachineMemoryBytes();
  // The longest time that the server waits for the answer to a request, and the limit of the
  // reader's processor time.
  std::chrono::milliseconds time{600'000};
  // The longest time that a reader may send nothing, unless it is waiting for its storage.
  std::chrono::milliseconds silence{60'000};
  // The flags by which users set these limits, for errors, such as "--sandbox-memory". A flag is
  // empty if the command has none.
  std::string memory_flag = {};
  std::string time_flag = {};
  std::string silence_flag = {};
  // A request to stop ends the reader in progress, and no further reader is started. The error is
  // CANCELLED.
  std::stop_token stop = {};
};

// Returns the path of thunderhead-reader, which is next to this program. Returns INTERNAL if it is
// missing. Returns UNAVAILABLE if another file has replaced it since the first call, because a
// reader of another version may have another layout of messages.
absl::StatusOr<std::string> ReaderProgram();

// Keeps the reader that was used last for a short time, because several requests about a file
// usually follow one another: description, heights, times. Safe from any thread.
class RestingReader {
 public:
  explicit RestingReader(const base::TimeSource& time) : time_(time) {}
  ~RestingReader();
  RestingReader(const RestingReader&) = delete;
  RestingReader& operator=(const RestingReader&) = delete;

  // Returns the kept reader if it has opened the files to which the request's paths lead now, else
  // null.
  std::unique_ptr<StartedReader> Take(const Request& request);
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

// Sends requests to readers and receives their results. The readers are processes of `program`, or
// of ReaderProgram() if `program` is empty. `time` measures how long they take, and must outlive
// this object. Safe from any thread.
class Readers {
 public:
  // A function that receives the rest of the result, after the kind of the reply. If a value is
  // impossible, it returns an error whose message names the value. Run checks afterwards whether
  // the Receiver has failed.
  using Take = std::function<absl::Status(Receiver& from_reader)>;

  // The longest time to wait for a result. If a trial takes longer, the result is ABORTED, and this
  // does not count as a failure of the reader.
  struct Patience {
    std::chrono::milliseconds time{};
    bool is_trial = false;
  };

  explicit Readers(const ReaderLimits& limits, const base::TimeSource& time = base::SteadyTime(),
                   std::string program = "", FileChecks checks = {});

  // Sends `request` to a reader and waits for its result, but no longer than `patience`. `wanted`
  // is the kind of reply that `take` receives. Returns the errors that the reader found in the
  // file, those with an unexpected status code as DATA_LOSS. If the reader fails, returns an error
  // for which IsReaderFailure or absl::IsUnavailable is true. `checkpoint` may be empty.
  absl::Status Run(Request request, Reply wanted, Patience patience,
                   const storm_files::ReadCheckpoint& checkpoint, const Take& take);

 private:
  // Returns nothing if `reader` was kept (`has_rested`) and has ended without a reply.
  std::optional<absl::Status> Ask(std::unique_ptr<StartedReader> reader, bool has_rested,
                                  const Request& request, Reply wanted, Patience patience,
                                  const storm_files::ReadCheckpoint& checkpoint, const Take& take);

  const ReaderLimits limits_;
  const base::TimeSource& time_;
  const std::string program_;
  const FileChecks checks_;
  RestingReader resting_;
};

// Returns whether an error means that the file made its reader fail. Returns false if the reader
// found the file invalid, or if the system killed the reader. A file that makes readers fail may be
// hostile, so it should not be read again soon.
bool IsReaderFailure(const absl::Status& status);

}  // namespace thunderhead::sandbox
