#include "gateway/open_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::gateway {
namespace {

// Retries a system call that a signal has interrupted.
template <typename SystemCall>
auto Uninterrupted(const SystemCall& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

}  // namespace

absl::StatusOr<std::shared_ptr<const OpenFile>> OpenFile::Open(const std::string& path,
                                                               std::weak_ptr<FileCloser> closer,
                                                               const Opener& open) {
  THUNDERHEAD_ASSIGN_OR_RETURN(base::FileDescriptor descriptor, open(path));
  struct stat information = {};
  if (::fstat(descriptor.Get(), &information) != 0) {
    return absl::UnavailableError(absl::StrCat("cannot read ", path, ": ", strerror(errno)));
  }
  ::posix_fadvise(descriptor.Get(), 0, 0, POSIX_FADV_SEQUENTIAL);
  return std::shared_ptr<const OpenFile>(new OpenFile(
      std::move(descriptor), static_cast<std::uint64_t>(information.st_size), std::move(closer)));
}

OpenFile::~OpenFile() {
  if (const auto closer = closer_.lock(); closer != nullptr) {
    closer->Close(std::move(descriptor_));
  } else {
    static_cast<void>(descriptor_.Release());
  }
}

std::ptrdiff_t OpenFile::Read(std::uint64_t offset, char* into, std::size_t most) const {
  return Uninterrupted(
      [&] { return ::pread(descriptor_.Get(), into, most, static_cast<off_t>(offset)); });
}

}  // namespace thunderhead::gateway
