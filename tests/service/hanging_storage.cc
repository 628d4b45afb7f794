// A library for LD_PRELOAD that makes a storage hang: opening a file waits for ever while there is
// another one beside it whose name ends with ".hangs". What is in a folder beside which there is a
// file whose name ends with ".mounted" is on another device.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdarg>
#include <cstdio>
#include <string>

namespace {

void HangIfTold(const char* path) {
  if (path == nullptr || access((std::string(path) + ".hangs").c_str(), F_OK) != 0) return;
  while (true) pause();
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

int statx(int folder, const char* path, int flags, unsigned int mask,
          struct statx* status) noexcept {
  const int result = Real<int(int, const char*, int, unsigned int, struct statx*)>("statx")(
      folder, path, flags, mask, status);
  if (result == 0 && IsMounted(path)) status->stx_dev_minor += 1000;
  return result;
}

}  // extern "C"
// NOLINTEND
