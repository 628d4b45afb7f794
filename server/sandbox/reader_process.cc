#include "sandbox/reader_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/file_descriptor.h"
#include "base/file_stamp.h"
#include "base/guarded.h"
#include "base/status.h"
#include "base/utf8.h"
#include "base/version.h"
#include "sandbox/reader_main.h"
#include "spdlog/spdlog.h"
#include "telemetry/metrics.h"
#include "volume/netcdf_file.h"

namespace thunderhead::sandbox {
namespace {

using std::chrono::milliseconds;

constexpr std::string_view kReaderFailed = "READER_FAILED";
constexpr char kWhatToDo[] =
    "; the file may be damaged or hostile: have it written again, or take it away";

absl::Status NoReader(const std::string& path, int error) {
  return absl::UnavailableError(absl::StrCat(path, ": no process can be started to read it (",
                                             std::strerror(error), "); try again"));
}

// An open descriptor of a regular file, never of a pipe or device that would block or act.
absl::StatusOr<base::FileDescriptor> OpenFile(const std::string& path) {
  base::FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (!file.IsOpen()) {
    const int error = errno;
    if (error == ENOENT) {
      return absl::NotFoundError(absl::StrCat(path, ": there is no such file; check the path"));
    }
    return absl::PermissionDeniedError(absl::StrCat(path, ": may not be read (",
                                                    std::strerror(error),
                                                    "); give this user permission to read it"));
  }
  struct stat information = {};
  if (fstat(file.Get(), &information) == 0 && S_ISREG(information.st_mode)) {
    // A folder may hold thousands of files of other kinds; none of them needs a process.
    THUNDERHEAD_RETURN_IF_ERROR(volume::NetcdfFile::CheckStart(path, file.Get()));
    return file;
  }
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": is no regular file; give the model's output file"));
}

// Processes that did not end at once when they were killed: those that give back much memory, and
// those that wait for a dead network file system. Asked again whenever another one ends.
void ReapLater(pid_t process) {
  static std::mutex mutex;
  static std::vector<pid_t> left;
  const std::lock_guard lock(mutex);
  if (process > 0) left.push_back(process);
  std::erase_if(left, [](pid_t each) { return waitpid(each, nullptr, WNOHANG) != 0; });
}

// A running reader; killed, and its end collected, when this object goes.
class Child {
 public:
  Child(pid_t process, const base::TimeSource& time) : process_(process), time_(time) {}
  ~Child() { Kill(); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void Kill() {
    if (process_ <= 0) return;
    kill(process_, SIGKILL);
    if (!End(milliseconds(2)).has_value()) ReapLater(std::exchange(process_, 0));
  }

  // The signal that ended it, 0 if it ended by itself, nothing if it still runs after `patience`.
  std::optional<int> End(milliseconds patience) {
    const auto until = time_.Now() + patience;
    int status = 0;
    while (process_ > 0) {
      const pid_t ended = waitpid(process_, &status, WNOHANG);
      if (ended != 0) {
        process_ = 0;
        ReapLater(0);
        return ended > 0 && WIFSIGNALED(status) ? WTERMSIG(status) : 0;
      }
      if (time_.Now() >= until) return std::nullopt;
      std::this_thread::sleep_for(milliseconds(1));
    }
    return 0;
  }

 private:
  pid_t process_;
  const base::TimeSource& time_;
};

// Variables that a program needs to start; none of this one's secrets.
std::vector<char*> Environment() {
  constexpr std::array<std::string_view, 5> kNames = {
      "LD_LIBRARY_PATH=", "ASAN_OPTIONS=", "UBSAN_OPTIONS=", "TSAN_OPTIONS=", "LSAN_OPTIONS="};
  std::vector<char*> kept;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text(*variable);
    const bool known = std::ranges::any_of(
        kNames, [text](std::string_view name) { return text.starts_with(name); });
    if (known) kept.push_back(*variable);
  }
  kept.push_back(nullptr);
  return kept;
}

// The descriptor with a number beyond those that the reader gets, which Spawn must not overwrite
// before it has copied them. A program whose standard streams are closed has it among those.
base::FileDescriptor MovedUp(base::FileDescriptor file) {
  constexpr int kBeyond = kSharedDescriptor + 1;
  if (!file.IsOpen() || file.Get() >= kBeyond) return file;
  return base::FileDescriptor(fcntl(file.Get(), F_DUPFD_CLOEXEC, kBeyond));
}

struct Unmap {
  std::size_t size = 0;

  void operator()(const std::byte* bytes) const { munmap(const_cast<std::byte*>(bytes), size); }
};

// Memory that the reader fills with arrays and this process reads. It takes no memory before it is
// written.
class SharedArrays {
 public:
  // Negative: there are none.
  int File() const { return file_.Get(); }
  std::span<const std::byte> Bytes() const { return {bytes_.get(), bytes_.get_deleter().size}; }

  // Without it arrays go through the pipe.
  static SharedArrays Make(std::size_t size) {
    SharedArrays arrays;
    base::FileDescriptor file(memfd_create("fields of a storm", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    // Sealed, as a memory that became smaller would end whoever reads it.
    constexpr int kSeals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;
    if (!file.IsOpen() || ftruncate(file.Get(), static_cast<off_t>(size)) != 0 ||
        fcntl(file.Get(), F_ADD_SEALS, kSeals) != 0) {
      return arrays;
    }
    void* const bytes = mmap(nullptr, size, PROT_READ, MAP_SHARED | MAP_NORESERVE, file.Get(), 0);
    if (bytes == MAP_FAILED) return arrays;
    arrays.bytes_ = {static_cast<const std::byte*>(bytes), Unmap{size}};
    arrays.file_ = MovedUp(std::move(file));
    return arrays;
  }

 private:
  base::FileDescriptor file_;
  std::unique_ptr<const std::byte, Unmap> bytes_;
};

// Returns the path of an open file, with no link in it.
std::string PlaceOf(const base::FileDescriptor& file) {
  std::error_code error;
  return std::filesystem::read_symlink(absl::StrCat("/proc/self/fd/", file.Get()), error).string();
}

// The descriptors that a reader inherits.
struct Descriptors {
  int request = -1;
  int reply = -1;
  int file = -1;
  int shared = -1;
};

// Starts the program with the descriptors that it may have, in a group of its own, so that Ctrl-C
// reaches the server alone. 0 and the process, or an error number.
int Spawn(const std::string& program, const Descriptors& given, pid_t& process) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_adddup2(&actions, given.request, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, given.reply, STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  int kept = kFileDescriptor;
  for (const int each : {given.file, given.shared}) {
    if (each >= 0) posix_spawn_file_actions_adddup2(&actions, each, kept++);
  }
  posix_spawn_file_actions_addclosefrom_np(&actions, kept);
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(
      &attributes,
      static_cast<short>(POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP));
  std::string name = kReaderName;
  const std::array<char*, 2> arguments = {name.data(), nullptr};
  const int error = posix_spawn(&process, program.c_str(), &actions, &attributes, arguments.data(),
                                Environment().data());
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  return error;
}

// Counts and logs; the error is for who asked.
absl::Status Failed(const std::string& path, const char* reason, absl::Status status) {
  telemetry::Counted().reader_failures.Of(reason).Add();
  status = absl::Status(status.code(), absl::StrCat(path, ": its reader ", status.message()));
  spdlog::warn("{}", std::string(status.message()));
  return base::WithDetails(std::move(status), {.reason = std::string(kReaderFailed)});
}

absl::Status TookTooLong(const std::string& path, milliseconds time) {
  return Failed(path, "time",
                absl::DeadlineExceededError(
                    absl::StrCat("was ended after ", absl::FormatDuration(absl::FromChrono(time)),
                                 " (--sandbox-seconds of `serve`)", kWhatToDo)));
}

// Why a reader ended without a result.
absl::Status EndedEarly(const std::string& path, int signal, milliseconds time) {
  if (signal == SIGXCPU) return TookTooLong(path, time);
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
                absl::DataLossError(
                    absl::StrCat("gave a result that cannot be right, by ", what, kWhatToDo)));
}

// Returns what the reader sent as one line of at most 2000 bytes.
std::string OneLine(const std::string& text) {
  constexpr std::size_t kLongest = 2000;
  return base::Printable(text.substr(0, kLongest));
}

void Log(const Note& note) {
  const bool warning = note.code >= static_cast<int>(spdlog::level::warn);
  spdlog::log(warning ? spdlog::level::warn : spdlog::level::info, "{}", OneLine(note.text));
}

// A status that the reader made of what the file says.
absl::Status StatusOf(const Note& note, const ReaderLimits& limits) {
  const auto code = static_cast<absl::StatusCode>(note.code);
  std::string text = OneLine(note.text);
  switch (code) {
    case absl::StatusCode::kResourceExhausted:
      absl::StrAppend(&text, " (reading a storm file may take ", limits.memory_bytes >> 20,
                      " MiB; --sandbox-memory of `serve` sets that)");
      // The limit is of this one reader, so waiting until others end does not help.
      return base::WithDetails(absl::ResourceExhaustedError(text), {.permanent = true});
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

// The error of a reader whose answer could not be received.
absl::Status Judge(const std::string& path, const Receiver& from_reader, Child& child,
                   const ReaderLimits& limits) {
  switch (from_reader.Why()) {
    case Receiver::Failure::kTooLate:
      return TookTooLong(path, limits.time);
    case Receiver::Failure::kTooLarge:
      return Nonsense(path, "its size");
    default:
      return EndedEarly(path, child.End(milliseconds(1000)).value_or(0), limits.time);
  }
}

// Hears the reader out. Its notes are limited, as it could talk for ever.
absl::Status Listen(const std::string& path, Receiver& from_reader, Reply wanted,
                    const volume::ReadCheckpoint& checkpoint, const ReaderProcess::Take& take,
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
  return Nonsense(path, "its kind");
}

}  // namespace

absl::Status ReaderProcess::Run(Request request, Reply wanted,
                                const volume::ReadCheckpoint& checkpoint, const Take& take) const {
  std::string program = program_;
  if (program.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(program, ReaderProgram());
  }
  request.version = base::Version();
  request.memory_bytes = limits_.memory_bytes;
  request.processor_s = static_cast<std::uint32_t>(
      std::max<std::int64_t>(1, std::chrono::ceil<std::chrono::seconds>(limits_.time).count()));
  base::FileDescriptor file;
  if (request.wanted != Wanted::kProbe) {
    THUNDERHEAD_ASSIGN_OR_RETURN(base::FileDescriptor opened, OpenFile(request.path));
    file = MovedUp(std::move(opened));
    if (check_opened_) THUNDERHEAD_RETURN_IF_ERROR(check_opened_(request.path, PlaceOf(file)));
  }
  SharedArrays shared;
  if (request.wanted == Wanted::kFields) shared = SharedArrays::Make(limits_.memory_bytes);
  request.shared_bytes = shared.Bytes().size();
  std::array<int, 2> asking{};
  std::array<int, 2> answering{};
  if (pipe2(asking.data(), O_CLOEXEC) != 0) return NoReader(request.path, errno);
  base::FileDescriptor request_from = MovedUp(base::FileDescriptor(asking[0]));
  {
    // Before anybody reads: it fits into the pipe, and the end of a reader is then no SIGPIPE.
    const base::FileDescriptor request_to(asking[1]);
    Sender to_reader(request_to.Get());
    Visit(to_reader, request);
  }
  if (pipe2(answering.data(), O_CLOEXEC) != 0) return NoReader(request.path, errno);
  const base::FileDescriptor reply_from(answering[0]);
  base::FileDescriptor reply_to = MovedUp(base::FileDescriptor(answering[1]));
  // Fewer switches between the processes; where it is not allowed, the pipe stays small.
  fcntl(reply_to.Get(), F_SETPIPE_SZ, 1 << 20);
  pid_t process = 0;
  const int error =
      Spawn(program, {request_from.Get(), reply_to.Get(), file.Get(), shared.File()}, process);
  if (error != 0) return NoReader(request.path, error);
  Child child(process, time_);
  request_from = {};
  reply_to = {};
  Receiver from_reader(reply_from.Get(), limits_.time, limits_.memory_bytes, time_, shared.Bytes());
  absl::Status status = base::Guarded(
      [&] { return Listen(request.path, from_reader, wanted, checkpoint, take, limits_); });
  if (!from_reader.Ok()) return Judge(request.path, from_reader, child, limits_);
  return status;
}

absl::StatusOr<std::string> ReaderProgram() {
  constexpr char kRemedy[] = "; install Thunderhead whole, and start this program again";
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  static const std::string path = (self.parent_path() / kReaderName).string();
  static const std::optional<base::FileStamp> first = base::StampOf(path);
  if (!first.has_value()) {
    return absl::InternalError(
        absl::StrCat(path, ", which reads storm files, is not there", kRemedy));
  }
  if (base::StampOf(path) == first) return path;
  return absl::UnavailableError(
      absl::StrCat(path, ", which reads storm files, was replaced", kRemedy));
}

std::uint64_t MachineMemory() {
  return static_cast<std::uint64_t>(std::max(sysconf(_SC_PHYS_PAGES), 1L)) *
         static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

bool IsReaderFailure(const absl::Status& status) {
  // One that was killed may well read the file the next time.
  return base::DetailsOf(status).reason == kReaderFailed && !absl::IsUnavailable(status);
}

}  // namespace thunderhead::sandbox
