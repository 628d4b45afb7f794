#include "sandbox/readers.h"

#include <algorithm>
#include <csignal>
#include <cstring>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/file_stamp.h"
#include "base/guarded.h"
#include "base/program_folder.h"
#include "base/status.h"
#include "base/version.h"
#include "sandbox/process_state.h"
#include "sandbox/reader_main.h"
#include "spdlog/spdlog.h"
#include "telemetry/metrics.h"

namespace thunderhead::sandbox {
namespace {

using std::chrono::milliseconds;

constexpr std::string_view kReaderFailed = "READER_FAILED";
constexpr char kWhatToDo[] = "; the file may be damaged or hostile: write it again, or remove it";

// Counts and logs a failure of a reader, and returns the error for the caller.
absl::Status Failed(const std::string& path, const char* reason, absl::Status status) {
  telemetry::Counted().reader_failures.Of(reason).Add();
  status = absl::Status(status.code(), absl::StrCat(path, ": its reader ", status.message()));
  spdlog::warn("{}", std::string(status.message()));
  return base::WithDetails(std::move(status), {.reason = std::string(kReaderFailed)});
}

// Returns a duration for a message, with the flag that sets it if there is one.
std::string LimitText(milliseconds time, const std::string& flag) {
  return absl::StrCat(absl::FormatDuration(absl::FromChrono(time)), flag.empty() ? "" : " (", flag,
                      flag.empty() ? "" : ")");
}

absl::Status TookTooLong(const std::string& path, const ReaderLimits& limits) {
  return Failed(path, "time",
                absl::DeadlineExceededError(absl::StrCat(
                    "was ended after ", LimitText(limits.time, limits.time_flag), kWhatToDo)));
}

absl::Status WasSilent(const std::string& path, const ReaderLimits& limits) {
  return Failed(
      path, "time",
      absl::DeadlineExceededError(absl::StrCat("was ended: it had given no result for ",
                                               LimitText(limits.silence, limits.silence_flag),
                                               ", although its storage answered", kWhatToDo)));
}

// Returns the error for a reader that ended without a result.
absl::Status EndedEarly(const std::string& path, int signal, const ReaderLimits& limits) {
  if (signal == SIGXCPU) return TookTooLong(path, limits);
  if (signal == SIGKILL) {
    return Failed(path, "killed",
                  absl::UnavailableError("was killed, probably because the machine's memory is "
                                         "full; free some, and try again"));
  }
  const std::string how =
      signal == 0 ? "ended without a result"
                  : absl::StrCat("crashed (signal ", signal, ", ", strsignal(signal), ")");
  return Failed(path, "crashed", absl::DataLossError(absl::StrCat(how, kWhatToDo)));
}

absl::Status Nonsense(const std::string& path, const std::string& what) {
  return Failed(path, "nonsense",
                absl::DataLossError(absl::StrCat("sent an invalid value for ", what, kWhatToDo)));
}

void Log(const Note& note) {
  const bool warning = note.code >= static_cast<int>(spdlog::level::warn);
  spdlog::log(warning ? spdlog::level::warn : spdlog::level::info, "{}", NoteText(note.text));
}

// Without a limit, returns a value that is larger than the memory of any machine.
std::uint64_t MemoryOf(const ReaderLimits& limits) {
  return limits.memory_bytes > 0 ? limits.memory_bytes : std::uint64_t{1} << 46;
}

// Returns the error for a file that needs more memory than a reader may use. The limit is for this
// reader only, so waiting until others end does not help.
absl::Status TooLarge(std::string text, const ReaderLimits& limits) {
  absl::StrAppend(&text, " (its reader may use ", MemoryOf(limits) >> 20, " MiB");
  if (!limits.memory_flag.empty()) absl::StrAppend(&text, "; ", limits.memory_flag, " sets that");
  absl::StrAppend(&text, ")");
  return base::WithDetails(absl::ResourceExhaustedError(text), {.permanent = true});
}

// Returns the status for an error that the reader found in the file.
absl::Status StatusOf(const Note& note, const ReaderLimits& limits) {
  const auto code = static_cast<absl::StatusCode>(note.code);
  std::string text = NoteText(note.text);
  switch (code) {
    case absl::StatusCode::kResourceExhausted:
      return TooLarge(std::move(text), limits);
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kPermissionDenied:
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kUnavailable:
      return {code, text};
    default:
      return absl::DataLossError(text);
  }
}

absl::Status Stopped(const std::string& path) {
  return absl::CancelledError(absl::StrCat(path, ": interrupted before it was read"));
}

// Returns the error for a reader whose answer could not be received.
absl::Status Judge(const std::string& path, const Receiver& from_reader, Child& child,
                   const ReaderLimits& limits) {
  switch (from_reader.Why()) {
    case Receiver::Failure::kTooLate:
      return TookTooLong(path, limits);
    case Receiver::Failure::kSilent:
      return WasSilent(path, limits);
    case Receiver::Failure::kStopped:
      return Stopped(path);
    case Receiver::Failure::kTooLarge:
      return Nonsense(path, "the size of its reply");
    default:
      return EndedEarly(path, child.End(milliseconds(1000)).value_or(0), limits);
  }
}

// Receives the reader's whole answer. The number of its notes is limited, because it could send
// them endlessly.
absl::Status Listen(const std::string& path, Receiver& from_reader, Reply wanted,
                    const storm_files::ReadCheckpoint& checkpoint, const Readers::Take& take,
                    const ReaderLimits& limits) {
  constexpr int kMaxNotes = 10'000;
  for (int notes = 0; notes < kMaxNotes; ++notes) {
    Reply reply = Reply::kError;
    from_reader(reply);
    if (!from_reader.Ok()) return absl::OkStatus();
    if (reply == Reply::kProgress) {
      double share = 0.0;
      from_reader(share);
      if (!from_reader.Ok()) return absl::OkStatus();
      if (!(share >= 0.0 && share <= 1.0)) break;
      if (checkpoint) THUNDERHEAD_RETURN_IF_ERROR(checkpoint(share));
    } else if (reply == Reply::kLog || reply == Reply::kError) {
      Note note;
      Visit(from_reader, note);
      if (!from_reader.Ok()) return absl::OkStatus();
      if (reply == Reply::kError) return StatusOf(note, limits);
      Log(note);
    } else if (reply == wanted) {
      const absl::Status taken = take(from_reader);
      if (taken.ok() || !from_reader.Ok()) return absl::OkStatus();
      return Nonsense(path, std::string(taken.message()));
    } else {
      break;
    }
  }
  return Nonsense(path, "the kind of its reply");
}

// The time for which an idle reader is kept for another request about its file.
constexpr std::chrono::seconds kRest{2};

}  // namespace

RestingReader::~RestingReader() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

std::unique_ptr<StartedReader> RestingReader::Take(const Request& request) {
  const std::lock_guard lock(mutex_);
  if (reader_ == nullptr || !reader_->Reads(request.path, request.bundled)) return nullptr;
  return std::exchange(reader_, nullptr);
}

void RestingReader::Put(std::unique_ptr<StartedReader> reader) {
  reader->Arrays().Empty();
  // The previous reader, which ends after the lock is released.
  std::unique_ptr<StartedReader> before;
  {
    const std::lock_guard lock(mutex_);
    before = std::exchange(reader_, std::move(reader));
    until_ = time_.Now() + kRest;
    try {
      if (!thread_.joinable()) thread_ = std::thread([this] { EndInTime(); });
    } catch (const std::system_error&) {
      // The system cannot start another thread, so the reader is ended now.
      before = std::exchange(reader_, nullptr);
    }
  }
  changed_.notify_all();
}

void RestingReader::EndInTime() {
  std::unique_lock lock(mutex_);
  while (!ending_) {
    if (reader_ == nullptr) {
      changed_.wait(lock);
    } else if (time_.Now() < until_) {
      changed_.wait_until(lock, time_.LookAgainAt(until_));
    } else {
      std::unique_ptr<StartedReader> ended = std::exchange(reader_, nullptr);
      lock.unlock();
      ended.reset();
      lock.lock();
    }
  }
}

Readers::Readers(const ReaderLimits& limits, const base::TimeSource& time, std::string program,
                 FileChecks checks)
    : limits_(limits),
      time_(time),
      program_(std::move(program)),
      checks_(std::move(checks)),
      resting_(time) {}

std::optional<absl::Status> Readers::Ask(std::unique_ptr<StartedReader> reader, bool has_rested,
                                         const Request& request, Reply wanted, Patience patience,
                                         const storm_files::ReadCheckpoint& checkpoint,
                                         const Take& take) {
  reader->Ask(request);
  ReaderLimits limits = limits_;
  // If the request has less time than the flag allows, the error does not name the flag, because a
  // larger value of the flag would not help.
  if (patience.time < limits.time) limits.time_flag.clear();
  limits.time = patience.time;
  Receiver from_reader(reader->Replies(), patience.time, request.memory_bytes, time_,
                       reader->Arrays().Bytes());
  StorageWatch storage(reader->Process().Process());
  from_reader.StopOn(limits.stop);
  from_reader.LimitSilence(limits.silence, [&storage] { return storage.ExplainsSilence(); });
  absl::Status status = base::Guarded(
      [&] { return Listen(request.path, from_reader, wanted, checkpoint, take, limits); });
  if (!from_reader.Ok()) {
    const bool ended = from_reader.Why() == Receiver::Failure::kEnded;
    if (has_rested && ended && !from_reader.AnythingCame()) return std::nullopt;
    if (patience.is_trial && from_reader.Why() == Receiver::Failure::kTooLate) {
      return absl::AbortedError(absl::StrCat(request.path, ": needs longer than ",
                                             absl::FormatDuration(absl::FromChrono(patience.time)),
                                             "; try again with a longer time limit"));
    }
    return Judge(request.path, from_reader, reader->Process(), limits);
  }
  // The kernel limits a reader's processor time over all its requests. A reader is therefore kept
  // only while enough of this time is left for another request.
  const bool is_young = time_.Now() - reader->Began() < limits_.time / 4;
  if (status.ok() && request.wanted != Wanted::kProbe && is_young) {
    resting_.Put(std::move(reader));
  }
  return status;
}

absl::Status Readers::Run(Request request, Reply wanted, Patience patience,
                          const storm_files::ReadCheckpoint& checkpoint, const Take& take) {
  if (limits_.stop.stop_requested()) return Stopped(request.path);
  request.version = base::Version();
  request.memory_bytes = MemoryOf(limits_);
  request.processor_s = static_cast<std::uint32_t>(
      std::max<std::int64_t>(1, std::chrono::ceil<std::chrono::seconds>(limits_.time).count()));
  if (std::unique_ptr<StartedReader> rested = resting_.Take(request); rested != nullptr) {
    std::optional<absl::Status> status =
        Ask(std::move(rested), true, request, wanted, patience, checkpoint, take);
    if (status.has_value()) return *status;
    // The kept reader has ended meanwhile, without an answer.
  }
  std::string program = program_;
  if (program.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(program, ReaderProgram());
  }
  auto reader = StartedReader::Start(program, request, checks_, time_);
  if (absl::IsResourceExhausted(reader.status())) {
    return TooLarge(std::string(reader.status().message()), limits_);
  }
  if (!reader.ok()) return reader.status();
  return *Ask(*std::move(reader), false, request, wanted, patience, checkpoint, take);
}

absl::StatusOr<std::string> ReaderProgram() {
  constexpr char kRemedy[] = "; install all of Thunderhead, and start this program again";
  static const std::string path = (base::ProgramFolder() / kReaderName).string();
  static const std::optional<base::FileStamp> first = base::StampOf(path);
  if (!first.has_value()) {
    return absl::InternalError(
        absl::StrCat(path, ", which reads storm files, does not exist", kRemedy));
  }
  const std::optional<base::FileStamp> now = base::StampOf(path);
  // The change time is ignored, because a backup that links the file under another name changes it.
  if (now.has_value() && now->Id() == first->Id() && now->size_bytes == first->size_bytes &&
      now->modified_ns == first->modified_ns) {
    return path;
  }
  return absl::UnavailableError(
      absl::StrCat(path, ", which reads storm files, was replaced", kRemedy));
}

bool IsReaderFailure(const absl::Status& status) {
  // A reader that was killed (UNAVAILABLE) is excluded, because the next reader may succeed.
  return base::DetailsOf(status).reason == kReaderFailed && !absl::IsUnavailable(status);
}

}  // namespace thunderhead::sandbox
