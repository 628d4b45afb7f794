#include "sandbox/started_reader.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/byte_source.h"
#include "base/status.h"
#include "sandbox/archive.h"
#include "sandbox/file_bundle.h"
#include "sandbox/reader_process.h"
#include "storm_files/storm_format.h"

namespace thunderhead::sandbox {
namespace {

absl::Status NoReader(const std::string& path, int error) {
  return absl::UnavailableError(absl::StrCat(path, ": no process can be started to read it (",
                                             std::strerror(error), "); try again"));
}

// Returns the variables that a program needs to start, and none of this process' secrets.
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
  // Reading allocates and frees arrays of some 100 MB repeatedly. By default, the allocator would
  // map each array anew, and the kernel would clear each of its pages of 4 kB separately. With
  // these settings the allocator keeps freed memory and asks for pages of 2 MB.
  static char malloc_keeps_memory[] =
      "GLIBC_TUNABLES=glibc.malloc.hugetlb=1:glibc.malloc.mmap_max=0:"
      "glibc.malloc.trim_threshold=1099511627776";
  kept.push_back(malloc_keeps_memory);
  kept.push_back(nullptr);
  return kept;
}

// Moves a descriptor to a number above the numbers that the reader inherits. Otherwise Spawn could
// overwrite a low-numbered descriptor before it has copied it. A server whose standard streams are
// closed gets such low numbers.
base::FileDescriptor MovedUp(base::FileDescriptor file) {
  constexpr int kBeyond = kSharedDescriptor + 1;
  if (!file.IsOpen() || file.Get() >= kBeyond) return file;
  return base::FileDescriptor(fcntl(file.Get(), F_DUPFD_CLOEXEC, kBeyond));
}

// Returns the path of an open file, with no link in it.
std::string PlaceOf(const base::FileDescriptor& file) {
  std::error_code error;
  return std::filesystem::read_symlink(absl::StrCat("/proc/self/fd/", file.Get()), error).string();
}

// Opens a file and checks its place and its first bytes. A folder may hold thousands of files of
// other kinds, and none of them needs a process.
absl::StatusOr<base::FileDescriptor> OpenForReader(const std::string& path,
                                                   const FileChecks& checks) {
  THUNDERHEAD_ASSIGN_OR_RETURN(base::FileDescriptor file, base::OpenRegularFile(path));
  if (checks.opened) THUNDERHEAD_RETURN_IF_ERROR(checks.opened(path, PlaceOf(file)));
  THUNDERHEAD_RETURN_IF_ERROR(checks.start(path, file.Get()));
  return file;
}

// The descriptors that a reader inherits.
struct Descriptors {
  int request = -1;
  int reply = -1;
  int file = -1;
  int shared = -1;
};

// Starts the program with the descriptors that it may have, in a separate process group, so that
// only the server receives Ctrl-C. Returns 0 and the process, or an error number.
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

}  // namespace

absl::Status CheckStormStart(const std::string& path, int file) {
  static const storm_files::StormFormats formats = storm_files::StormFormats::BuiltIn();
  return formats.CheckStart(path, file);
}

void UnmapBytes::operator()(const std::byte* bytes) const {
  munmap(const_cast<std::byte*>(bytes), size);
}

SharedArrays SharedArrays::Make(std::size_t size) {
  SharedArrays arrays;
  base::FileDescriptor file(memfd_create("fields of a storm", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  // The memory is sealed, because shrinking it would crash a process that reads it.
  constexpr int kSeals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;
  if (!file.IsOpen() || ftruncate(file.Get(), static_cast<off_t>(size)) != 0 ||
      fcntl(file.Get(), F_ADD_SEALS, kSeals) != 0) {
    return arrays;
  }
  void* const bytes = mmap(nullptr, size, PROT_READ, MAP_SHARED | MAP_NORESERVE, file.Get(), 0);
  if (bytes == MAP_FAILED) return arrays;
  arrays.bytes_ = {static_cast<const std::byte*>(bytes), UnmapBytes{size}};
  arrays.file_ = MovedUp(std::move(file));
  return arrays;
}

void SharedArrays::Empty() {
  if (!file_.IsOpen()) return;
  fallocate(file_.Get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0,
            static_cast<off_t>(Bytes().size()));
}

bool StartedReader::Reads(const std::string& path, const std::vector<std::string>& bundled) const {
  if (path != path_ || bundled != bundled_ || stamps_.empty()) return false;
  for (std::size_t i = 0; i < stamps_.size(); ++i) {
    if (base::StampOf(bundled.empty() ? path : bundled[i]) != stamps_[i]) return false;
  }
  return true;
}

absl::StatusOr<std::unique_ptr<StartedReader>> StartedReader::Start(const std::string& program,
                                                                    const Request& first,
                                                                    const FileChecks& checks,
                                                                    const base::TimeSource& time) {
  absl::StatusOr<ChildPlace> place = ChildPlace::Take();
  if (!place.ok()) return base::Annotate(place.status(), first.path);
  FileBundle given;
  SharedArrays arrays;
  const auto open = [&](const std::string& path) { return OpenForReader(path, checks); };
  if (first.bundle != 0) {
    THUNDERHEAD_ASSIGN_OR_RETURN(given, Bundle(first.bundled, open, first.memory_bytes));
  } else if (first.wanted != Wanted::kProbe) {
    THUNDERHEAD_ASSIGN_OR_RETURN(given.file, open(first.path));
    const auto stamp = base::StampOf(absl::StrCat("/proc/self/fd/", given.file.Get()));
    if (stamp.has_value()) given.stamps.push_back(*stamp);
  }
  given.file = MovedUp(std::move(given.file));
  if (first.wanted != Wanted::kProbe) arrays = SharedArrays::Make(first.memory_bytes);
  std::array<int, 2> asking{};
  std::array<int, 2> answering{};
  if (pipe2(asking.data(), O_CLOEXEC) != 0) return NoReader(first.path, errno);
  base::FileDescriptor requests_from = MovedUp(base::FileDescriptor(asking[0]));
  base::FileDescriptor requests(asking[1]);
  if (pipe2(answering.data(), O_CLOEXEC) != 0) return NoReader(first.path, errno);
  base::FileDescriptor replies(answering[0]);
  const base::FileDescriptor replies_to = MovedUp(base::FileDescriptor(answering[1]));
  // A larger pipe needs fewer switches between the processes. If the system does not allow the
  // size, the pipe keeps its default size.
  fcntl(replies_to.Get(), F_SETPIPE_SZ, 1 << 20);
  pid_t process = 0;
  const int error = Spawn(
      program, {requests_from.Get(), replies_to.Get(), given.file.Get(), arrays.File()}, process);
  if (error != 0) return NoReader(first.path, error);
  std::unique_ptr<StartedReader> reader(
      new StartedReader(first.path, process, *std::move(place), time));
  reader->bundled_ = first.bundled;
  reader->stamps_ = std::move(given.stamps);
  reader->arrays_ = std::move(arrays);
  reader->requests_ = std::move(requests);
  reader->requests_from_ = std::move(requests_from);
  reader->replies_ = std::move(replies);
  return reader;
}

void StartedReader::Ask(Request request) {
  request.shared_bytes = arrays_.Bytes().size();
  Sender to_reader(requests_.Get());
  Visit(to_reader, request);
}

}  // namespace thunderhead::sandbox
