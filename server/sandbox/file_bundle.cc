#include "sandbox/file_bundle.h"

#include <sys/mman.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::sandbox {
namespace {

absl::Status CannotBeCopied(const std::string& path, int error) {
  return absl::UnavailableError(absl::StrCat(path,
                                             ": cannot be copied for the process that reads it (",
                                             std::strerror(error), "); try again"));
}

absl::Status Write(int to, const std::string& path, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(to, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return CannotBeCopied(path, errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return absl::OkStatus();
}

absl::Status Copy(int from, int to, const std::string& path, std::uint64_t size) {
  while (size > 0) {
    const ssize_t count = sendfile(to, from, nullptr, size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return CannotBeCopied(path, errno);
    if (count == 0) {
      return absl::UnavailableError(
          absl::StrCat(path, ": became shorter while it was read; try again"));
    }
    size -= static_cast<std::uint64_t>(count);
  }
  return absl::OkStatus();
}

template <typename Number>
void Append(Number number, std::string& table) {
  table.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

// Takes bytes from the front of a bundle.
class Taker {
 public:
  explicit Taker(std::span<const std::byte> bytes) : rest_(bytes) {}

  // Returns `size` bytes. If fewer are left, returns none, and Ok() is false from then on.
  std::span<const std::byte> Take(std::uint64_t size) {
    if (size > rest_.size()) ok_ = false;
    if (!ok_) return {};
    const std::span<const std::byte> taken = rest_.first(size);
    rest_ = rest_.subspan(size);
    return taken;
  }

  template <typename Number>
  Number TakeNumber() {
    Number number = 0;
    const std::span<const std::byte> bytes = Take(sizeof(number));
    if (ok_) std::memcpy(&number, bytes.data(), sizeof(number));
    return number;
  }

  bool Ok() const { return ok_; }

 private:
  std::span<const std::byte> rest_;
  bool ok_ = true;
};

}  // namespace

absl::StatusOr<FileBundle> Bundle(const std::vector<std::string>& paths, const OpenChecked& open,
                                  std::size_t most_bytes) {
  FileBundle bundle;
  bundle.file = base::FileDescriptor(memfd_create("files of a storm", MFD_CLOEXEC));
  if (!bundle.file.IsOpen()) return CannotBeCopied(paths.front(), errno);
  std::string table;
  Append(static_cast<std::uint32_t>(paths.size()), table);
  std::uint64_t total = 0;
  for (const std::string& path : paths) {
    const std::optional<base::FileStamp> stamp = base::StampOf(path);
    if (!stamp.has_value()) {
      return absl::NotFoundError(absl::StrCat(path, ": the file no longer exists"));
    }
    bundle.stamps.push_back(*stamp);
    total += static_cast<std::uint64_t>(stamp->size_bytes);
    Append(static_cast<std::uint32_t>(path.size()), table);
    table += path;
    Append(static_cast<std::uint64_t>(stamp->size_bytes), table);
  }
  if (total > most_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat(paths.front(), " and the ", paths.size() - 1, " other files of its time have ",
                     total >> 20, " MiB, more than the ", most_bytes >> 20,
                     " MiB that may be read; give fewer or smaller files"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(Write(bundle.file.Get(), paths.front(), table));
  for (std::size_t i = 0; i < paths.size(); ++i) {
    // One file is open at a time, because there may be more files than descriptors.
    THUNDERHEAD_ASSIGN_OR_RETURN(const base::FileDescriptor file, open(paths[i]));
    const auto size = static_cast<std::uint64_t>(bundle.stamps[i].size_bytes);
    THUNDERHEAD_RETURN_IF_ERROR(Copy(file.Get(), bundle.file.Get(), paths[i], size));
  }
  return bundle;
}

absl::StatusOr<std::vector<BundledFile>> FilesOfBundle(std::span<const std::byte> bytes) {
  Taker taker(bytes);
  const auto count = taker.TakeNumber<std::uint32_t>();
  std::vector<BundledFile> files;
  std::vector<std::uint64_t> sizes;
  for (std::uint32_t i = 0; i < count && taker.Ok(); ++i) {
    const std::span<const std::byte> path = taker.Take(taker.TakeNumber<std::uint32_t>());
    files.push_back({std::string(reinterpret_cast<const char*>(path.data()), path.size()), {}});
    sizes.push_back(taker.TakeNumber<std::uint64_t>());
  }
  for (std::size_t i = 0; i < files.size() && taker.Ok(); ++i) {
    files[i].bytes = taker.Take(sizes[i]);
  }
  if (taker.Ok()) return files;
  return absl::InternalError("the files of a time arrived incomplete");
}

}  // namespace thunderhead::sandbox
