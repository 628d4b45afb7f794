// An open file descriptor that its destructor closes, and reading from it.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <string>
#include <utility>

namespace thunderhead::base {

class FileDescriptor {
 public:
  FileDescriptor() = default;
  // A negative number means that there is no descriptor.
  explicit FileDescriptor(int number) : number_(number) {}
  FileDescriptor(FileDescriptor&& other) noexcept : number_(other.Release()) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~FileDescriptor() {
    if (number_ >= 0) close(number_);
  }

  int Get() const { return number_; }
  bool IsOpen() const { return number_ >= 0; }
  // Hands the descriptor to the caller, who must close it.
  int Release() { return std::exchange(number_, -1); }

 private:
  int number_ = -1;
};

// Appends the rest of the open file to `bytes`, until it ends or `bytes` has `max_bytes`. Returns 0
// or the error code of the system.
int ReadUpTo(const FileDescriptor& file, std::size_t max_bytes, std::string& bytes);

}  // namespace thunderhead::base
