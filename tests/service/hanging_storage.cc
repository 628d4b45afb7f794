// A library for LD_PRELOAD that makes a storage hang: opening a file waits for ever while there is
// another one beside it whose name ends with ".hangs". Where that is beside a folder, so does all
// that is done to what is in it, also to files that are open. What is in a folder beside which
// there is a file whose name ends with ".mounted" is on another device.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <string>

namespace {

void HangIfTold(const char* path) {
  if (path == nullptr) return;
  for (std::string at = path; at.size() > 1; at.resize(at.rfind('/'))) {
    if (access((at + ".hangs").c_str(), F_OK) == 0) {
      while (true) pause();
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

}  // namespace

// NOLINTBEGIN: the C library's own names
extern "C" {

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
  // Of a file that is marked itself the status still comes.
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
