#include "base/byte_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/file_descriptor.h"
#include "base/status.h"

namespace thunderhead::base {
namespace {

using Registered = std::map<std::string, std::span<const std::byte>>;

Registered& RegisteredFiles() {
  static Registered files;
  return files;
}

absl::Status EndsBefore(const ByteSource& file, std::uint64_t offset, std::size_t size) {
  return absl::DataLossError(absl::StrCat(
      file.Path(), ": ends at byte ", file.Size_bytes(), ", before byte ", offset + size,
      ", which its headers announce; it was cut short: copy the file again"));
}

class MemoryBytes final : public ByteSource {
 public:
  MemoryBytes(std::string path, std::span<const std::byte> bytes)
      : path_(std::move(path)), bytes_(bytes) {}

  const std::string& Path() const override { return path_; }
  std::uint64_t Size_bytes() const override { return bytes_.size(); }
  absl::Status Read(std::uint64_t offset, std::span<std::byte> to) const override {
    if (offset > bytes_.size() || to.size() > bytes_.size() - offset) {
      return EndsBefore(*this, offset, to.size());
    }
    std::ranges::copy(bytes_.subspan(offset, to.size()), to.begin());
    return absl::OkStatus();
  }

 private:
  const std::string path_;
  const std::span<const std::byte> bytes_;
};

class FileBytes final : public ByteSource {
 public:
  FileBytes(std::string path, FileDescriptor file, std::uint64_t size)
      : path_(std::move(path)), file_(std::move(file)), size_(size) {}

  const std::string& Path() const override { return path_; }
  std::uint64_t Size_bytes() const override { return size_; }
  absl::Status Read(std::uint64_t offset, std::span<std::byte> to) const override {
    if (offset > size_ || to.size() > size_ - offset) return EndsBefore(*this, offset, to.size());
    while (!to.empty()) {
      const ssize_t count = pread(file_.Get(), to.data(), to.size(), static_cast<off_t>(offset));
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) {
        return absl::UnavailableError(
            absl::StrCat(path_, ": cannot be read (", std::strerror(errno), "); try again"));
      }
      if (count == 0) return EndsBefore(*this, offset, to.size());
      to = to.subspan(static_cast<std::size_t>(count));
      offset += static_cast<std::uint64_t>(count);
    }
    return absl::OkStatus();
  }

 private:
  const std::string path_;
  const FileDescriptor file_;
  const std::uint64_t size_;
};

absl::Status NoRegularFile(const std::string& path) {
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": is not a regular file; give the model's output file"));
}

// Returns the error `code` of opening a file.
absl::Status NotOpened(const std::string& path, int code) {
  const std::string why = absl::StrCat(" (", std::strerror(code), ")");
  switch (code) {
    case ENOENT:
      return absl::NotFoundError(absl::StrCat(path, ": there is no such file; check the path"));
    case ENOTDIR:
    case ELOOP:
    case ENAMETOOLONG:
      return absl::NotFoundError(absl::StrCat(path, ": leads to no file", why, "; check the path"));
    case ENXIO:  // a socket, or a device that does not exist
    case ENODEV:
      return NoRegularFile(path);
    case EACCES:
    case EPERM:
      return absl::PermissionDeniedError(
          absl::StrCat(path, ": may not be read", why, "; give this user permission to read it"));
    case EMFILE:
    case ENFILE:
      return absl::UnavailableError(absl::StrCat(path, ": cannot be opened", why,
                                                 "; try again, or raise the limit of open files"));
    default:
      return absl::UnavailableError(absl::StrCat(path, ": cannot be opened", why, "; try again"));
  }
}

}  // namespace

absl::StatusOr<FileDescriptor> OpenRegularFile(const std::string& path) {
  FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (!file.IsOpen()) return NotOpened(path, errno);
  struct stat information = {};
  if (fstat(file.Get(), &information) == 0 && S_ISREG(information.st_mode)) return file;
  return NoRegularFile(path);
}

void ReadFromMemory(const std::string& path, std::span<const std::byte> bytes) {
  RegisteredFiles()[path] = bytes;
}

std::optional<std::span<const std::byte>> RegisteredBytes(const std::string& path) {
  const auto at = RegisteredFiles().find(path);
  return at == RegisteredFiles().end() ? std::nullopt : std::optional(at->second);
}

bool ReadsOnlyFromMemory() { return !RegisteredFiles().empty(); }

absl::StatusOr<std::shared_ptr<const ByteSource>> OpenBytes(const std::string& path) {
  if (ReadsOnlyFromMemory()) {
    const auto bytes = RegisteredBytes(path);
    if (bytes.has_value()) return std::make_shared<MemoryBytes>(path, *bytes);
    return absl::PermissionDeniedError(
        absl::StrCat(path, ": is not the file that this process was started to read"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(FileDescriptor file, OpenRegularFile(path));
  struct stat information = {};
  if (fstat(file.Get(), &information) != 0) return NoRegularFile(path);
  return std::make_shared<FileBytes>(path, std::move(file),
                                     static_cast<std::uint64_t>(information.st_size));
}

}  // namespace thunderhead::base
