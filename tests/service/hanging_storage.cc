// A library for LD_PRELOAD that makes a storage hang. Opening FILE blocks while a file FILE.hangs
// exists. While FOLDER.hangs exists, every operation on a file in the folder blocks, also on files
// that are already open. A blocked call creates FILE.hung or FOLDER.hung, so that a test can detect
// it. The call continues once that file is removed. The contents of a folder are on another device
// if FOLDER.mounted exists.
//
// The library also controls the program's monotonic clock if THUNDERHEAD_TEST_CLOCK names a file,
// so that a slow machine is never mistaken for a storage that hangs. The clock then runs at a tenth
// of the real speed, and is ahead by the file's number of nanoseconds (int64_t). A test may raise
// that number. If THUNDERHEAD_TEST_WALL_CLOCK is set, the system's clock shows this number of
// seconds since 1970.
#include <dlfcn.h>
#include <fcntl.h>
#include <linux/futex.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <bits/atomic_futex.h>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
// Longest time in nanoseconds after which a waiting call notices that the test has advanced the
// clock.
constexpr std::int64_t kLookAgain_ns = 10'000'000;
// Real nanoseconds per nanosecond of a clock that a test controls.
constexpr std::int64_t kSlowness = 10;

timespec TimespecOf(std::int64_t ns) { return {ns / kSecond_ns, ns % kSecond_ns}; }

std::int64_t NanosecondsOf(const timespec& time) {
  return std::int64_t{time.tv_sec} * kSecond_ns + time.tv_nsec;
}

void HangIfTold(const char* path) {
  if (path == nullptr) return;
  for (std::string at = path; at.size() > 1; at.resize(at.rfind('/'))) {
    const std::string mark = at + ".hangs";
    if (access(mark.c_str(), F_OK) == 0) {
      const std::string hung = at + ".hung";
      const auto file = syscall(SYS_openat, AT_FDCWD, hung.c_str(), O_WRONLY | O_CREAT, 0600);
      if (file >= 0) close(static_cast<int>(file));
      const timespec pause = TimespecOf(kLookAgain_ns);
      while (access(mark.c_str(), F_OK) == 0 && (file < 0 || access(hung.c_str(), F_OK) == 0)) {
        nanosleep(&pause, nullptr);
      }
    }
    if (at.find('/') == std::string::npos) return;
  }
}

void HangIfTold(int file) {
  char path[4096];
  const ssize_t length =
      readlink(("/proc/self/fd/" + std::to_string(file)).c_str(), path, sizeof(path) - 1);
  if (length <= 0 || path[0] != '/') return;
  path[length] = '\0';
  HangIfTold(path);
}

bool IsMounted(const char* path) {
  if (path == nullptr) return false;
  const std::string file(path);
  const std::size_t slash = file.rfind('/');
  if (slash == std::string::npos) return false;
  return access((file.substr(0, slash) + ".mounted").c_str(), F_OK) == 0;
}

template <typename Function>
Function* Real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

class Clock {
 public:
  static const Clock& Get() {
    static const Clock clock;
    return clock;
  }

  static std::int64_t Real_ns() {
    static auto* const real = Real<int(clockid_t, timespec*)>("clock_gettime");
    timespec now{};
    real(CLOCK_MONOTONIC, &now);
    return NanosecondsOf(now);
  }

  std::int64_t Now_ns() const {
    if (ahead_ns_ == nullptr) return Real_ns();
    return start_ns_ + (Real_ns() - start_ns_) / kSlowness + ahead_ns_->load();
  }

  // Returns how long a wait until `deadline_ns` may block before it must read the clock again.
  std::int64_t Slice_ns(std::int64_t deadline_ns) const {
    return std::clamp<std::int64_t>(deadline_ns - Now_ns(), 0, kLookAgain_ns);
  }

 private:
  Clock() {
    const char* const path = std::getenv("THUNDERHEAD_TEST_CLOCK");
    if (path == nullptr) return;
    const auto file = static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, O_RDONLY | O_CLOEXEC));
    if (file < 0) return;
    void* const mapped = mmap(nullptr, sizeof(*ahead_ns_), PROT_READ, MAP_SHARED, file, 0);
    if (mapped != MAP_FAILED) ahead_ns_ = static_cast<const std::atomic<std::int64_t>*>(mapped);
    close(file);
  }

  const std::int64_t start_ns_ = Real_ns();
  const std::atomic<std::int64_t>* ahead_ns_ = nullptr;
};

// Returns whether the code at `address` belongs to gRPC, which keeps the real clock. With an
// advanced clock, gRPC would take clients that do not answer within a few seconds for disconnected.
bool IsInGrpc(const void* address) {
  static void* const a_function = dlsym(RTLD_DEFAULT, "gpr_now");
  Dl_info grpc{};
  Dl_info caller{};
  return a_function != nullptr && dladdr(a_function, &grpc) != 0 && dladdr(address, &caller) != 0 &&
         grpc.dli_fbase == caller.dli_fbase;
}

}  // namespace

// NOLINTBEGIN: the names of libstdc++, which waits for futures by this function
namespace std {

// Returns false if the deadline has passed. A return of true may be spurious, so the caller checks
// again.
bool __atomic_futex_unsigned_base::_M_futex_wait_until_steady(unsigned* address, unsigned value,
                                                              bool has_timeout,
                                                              chrono::seconds seconds,
                                                              chrono::nanoseconds nanoseconds) {
  const Clock& clock = Clock::Get();
  const int64_t deadline_ns = chrono::nanoseconds(seconds).count() + nanoseconds.count();
  if (has_timeout && clock.Now_ns() >= deadline_ns) return false;
  const timespec slice = TimespecOf(has_timeout ? clock.Slice_ns(deadline_ns) : kLookAgain_ns);
  syscall(SYS_futex, address, FUTEX_WAIT_PRIVATE, value, &slice, nullptr, 0);
  return true;
}

}  // namespace std
// NOLINTEND

// NOLINTBEGIN: the C library's own names
extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const char* const wall =
      clock == CLOCK_REALTIME ? getenv("THUNDERHEAD_TEST_WALL_CLOCK") : nullptr;
  if (wall != nullptr) {
    *time = {atoll(wall), 0};
    return 0;
  }
  if (clock != CLOCK_MONOTONIC || IsInGrpc(__builtin_return_address(0))) {
    static auto* const real = Real<int(clockid_t, timespec*)>("clock_gettime");
    return real(clock, time);
  }
  *time = TimespecOf(Clock::Get().Now_ns());
  return 0;
}

// Wakes up spuriously, so that its caller reads the clock again.
int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                           const timespec* deadline) {
  static auto* const real =
      Real<int(pthread_cond_t*, pthread_mutex_t*, clockid_t, const timespec*)>(
          "pthread_cond_clockwait");
  if (clock != CLOCK_MONOTONIC) return real(condition, mutex, clock, deadline);
  const std::int64_t slice_ns = Clock::Get().Slice_ns(NanosecondsOf(*deadline));
  const timespec slice_end = TimespecOf(Clock::Real_ns() + slice_ns);
  const int result = real(condition, mutex, clock, &slice_end);
  if (result != ETIMEDOUT) return result;
  return Clock::Get().Now_ns() >= NanosecondsOf(*deadline) ? ETIMEDOUT : 0;
}

FILE* fopen(const char* path, const char* mode) {
  HangIfTold(path);
  return Real<FILE*(const char*, const char*)>("fopen")(path, mode);
}

FILE* fopen64(const char* path, const char* mode) {
  HangIfTold(path);
  return Real<FILE*(const char*, const char*)>("fopen64")(path, mode);
}

int open(const char* path, int flags, ...) {
  HangIfTold(path);
  va_list rest;
  va_start(rest, flags);
  const int mode = va_arg(rest, int);
  va_end(rest);
  return Real<int(const char*, int, ...)>("open")(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  HangIfTold(path);
  va_list rest;
  va_start(rest, flags);
  const int mode = va_arg(rest, int);
  va_end(rest);
  return Real<int(const char*, int, ...)>("open64")(path, flags, mode);
}

ssize_t write(int file, const void* bytes, size_t size) {
  HangIfTold(file);
  return Real<ssize_t(int, const void*, size_t)>("write")(file, bytes, size);
}

ssize_t pwrite(int file, const void* bytes, size_t size, off_t at) {
  HangIfTold(file);
  return Real<ssize_t(int, const void*, size_t, off_t)>("pwrite")(file, bytes, size, at);
}

ssize_t pwrite64(int file, const void* bytes, size_t size, off64_t at) {
  HangIfTold(file);
  return Real<ssize_t(int, const void*, size_t, off64_t)>("pwrite64")(file, bytes, size, at);
}

int fsync(int file) {
  HangIfTold(file);
  return Real<int(int)>("fsync")(file);
}

int fdatasync(int file) {
  HangIfTold(file);
  return Real<int(int)>("fdatasync")(file);
}

int mkdir(const char* path, mode_t mode) noexcept {
  HangIfTold(path);
  return Real<int(const char*, mode_t)>("mkdir")(path, mode);
}

int remove(const char* path) noexcept {
  HangIfTold(path);
  return Real<int(const char*)>("remove")(path);
}

int unlink(const char* path) noexcept {
  HangIfTold(path);
  return Real<int(const char*)>("unlink")(path);
}

int statx(int folder, const char* path, int flags, unsigned int mask,
          struct statx* status) noexcept {
  // A call for the status of a file blocks only if its folder is marked, not if the file itself is
  // marked.
  if (const char* const name = path == nullptr ? nullptr : strrchr(path, '/'); name != nullptr) {
    HangIfTold(std::string(path, name).c_str());
  }
  const int result = Real<int(int, const char*, int, unsigned int, struct statx*)>("statx")(
      folder, path, flags, mask, status);
  if (result == 0 && IsMounted(path)) status->stx_dev_minor += 1000;
  return result;
}

}  // extern "C"
// NOLINTEND
