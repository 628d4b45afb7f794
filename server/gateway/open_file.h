// A regular file that is open for reading. Its functions may block as long as the storage does, so
// the gateway calls them by FileThreads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "base/file_descriptor.h"

namespace thunderhead::gateway {

class OpenFile {
 public:
  static absl::StatusOr<std::shared_ptr<const OpenFile>> Open(const std::string& path);

  // When it was opened.
  std::uint64_t Bytes() const { return bytes_; }
  // Reads at most `most` bytes from `offset` on; none at the file's end, fewer than 0 after an
  // error.
  std::ptrdiff_t Read(std::uint64_t offset, char* into, std::size_t most) const;

 private:
  OpenFile(base::FileDescriptor descriptor, std::uint64_t bytes)
      : descriptor_(std::move(descriptor)), bytes_(bytes) {}

  const base::FileDescriptor descriptor_;
  const std::uint64_t bytes_;
};

}  // namespace thunderhead::gateway
