#include "base/file_descriptor.h"

#include <algorithm>
#include <cerrno>

namespace thunderhead::base {
namespace {

constexpr std::size_t kBlock_bytes = 64 << 10;

}  // namespace

int ReadUpTo(const FileDescriptor& file, std::size_t max_bytes, std::string& bytes) {
  while (bytes.size() < max_bytes) {
    const std::size_t before = bytes.size();
    bytes.resize(before + std::min(kBlock_bytes, max_bytes - before));
    const ssize_t count = ::read(file.Get(), bytes.data() + before, bytes.size() - before);
    const int code = errno;
    bytes.resize(before + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    if (count == 0) break;
    if (count < 0 && code != EINTR) return code;
  }
  return 0;
}

}  // namespace thunderhead::base
