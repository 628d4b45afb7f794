// A regular file that is open for reading. Its functions may block as long as the storage does, so
// the gateway calls them on FileThreads. Destroying the object does not block.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "base/file_descriptor.h"
#include "base/own_file.h"
#include "gateway/file_closer.h"

namespace thunderhead::gateway {

class OpenFile {
 public:
  using Opener = std::function<absl::StatusOr<base::FileDescriptor>(const std::string& path)>;

  // Opens a file by `open`, and returns its errors. `closer` will close it; if the closer no longer
  // exists then, the file is left open.
  static absl::StatusOr<std::shared_ptr<const OpenFile>> Open(
      const std::string& path, std::weak_ptr<FileCloser> closer,
      const Opener& open = &base::OpenOwnFile);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  // Returns the size that the file had when it was opened.
  std::uint64_t Bytes() const { return bytes_; }
  // Reads at most `most` bytes from `offset`. Returns 0 at the end of the file, and a negative
  // number after an error.
  std::ptrdiff_t Read(std::uint64_t offset, char* into, std::size_t most) const;

 private:
  OpenFile(base::FileDescriptor descriptor, std::uint64_t bytes, std::weak_ptr<FileCloser> closer)
      : descriptor_(std::move(descriptor)), bytes_(bytes), closer_(std::move(closer)) {}

  base::FileDescriptor descriptor_;
  const std::uint64_t bytes_;
  const std::weak_ptr<FileCloser> closer_;
};

}  // namespace thunderhead::gateway
