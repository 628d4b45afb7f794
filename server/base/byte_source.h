// The bytes of a file, wherever they are: on a disk, in memory that was mapped for this process, or
// (later) behind HTTP ranges. Readers of formats use this instead of paths and descriptors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "absl/status/statusor.h"
#include "base/file_descriptor.h"

namespace thunderhead::base {

// Safe to call from any thread.
class ByteSource {
 public:
  virtual ~ByteSource() = default;

  // Returns the path or address for messages.
  virtual const std::string& Path() const = 0;

  virtual std::uint64_t Size_bytes() const = 0;

  // Fills `to` with the bytes that begin at `offset`. Returns DATA_LOSS if the file ends before,
  // and UNAVAILABLE if the storage fails. Then the contents of `to` are unspecified.
  virtual absl::Status Read(std::uint64_t offset, std::span<std::byte> to) const = 0;
};

// Opens a regular file for reading, but never a pipe or device, because opening one could block or
// have side effects. Errors: NOT_FOUND; PERMISSION_DENIED; INVALID_ARGUMENT (no regular file);
// UNAVAILABLE (the storage fails, or too many files are open).
absl::StatusOr<FileDescriptor> OpenRegularFile(const std::string& path);

// Opens the file at `path`. If its bytes were registered by ReadFromMemory, these are used.
// Errors are those of OpenRegularFile.
absl::StatusOr<std::shared_ptr<const ByteSource>> OpenBytes(const std::string& path);

// Makes OpenBytes use `bytes` for `path`, and refuse every path that was not registered. It is for
// a process that may not open files. The bytes must stay valid. Not safe from several threads.
void ReadFromMemory(const std::string& path, std::span<const std::byte> bytes);

// Returns the bytes that were registered for `path`, or nothing if there are none.
std::optional<std::span<const std::byte>> RegisteredBytes(const std::string& path);

// Returns whether this process reads files only from registered memory.
bool ReadsOnlyFromMemory();

}  // namespace thunderhead::base
