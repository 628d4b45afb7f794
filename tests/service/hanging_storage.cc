// A library for LD_PRELOAD that makes a storage hang: opening a file waits for ever while there is
// another one beside it whose name ends with ".hangs".
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <cstdarg>
#include <cstdio>
#include <string>

namespace {

void HangIfTold(const char* path) {
  if (path == nullptr || access((std::string(path) + ".hangs").c_str(), F_OK) != 0) return;
  while (true) pause();
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

}  // extern "C"
// NOLINTEND
