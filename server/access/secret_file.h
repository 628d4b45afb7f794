// Reads files that decide who may enter: only such as nobody else on the machine could have
// written, or, where they are secret, read.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "base/file_stamp.h"

namespace thunderhead::access {

// FAILED_PRECONDITION, with the command that mends it, for a file that belongs to another user,
// that others may write, or that everybody may read.
absl::StatusOr<std::string> ReadSecretFile(const std::string& path);

// The text of a file, read again when it has changed. The error of a changed file is logged,
// and the last good contents stay valid: a slip of the editor locks nobody out. Safe from any
// thread.
template <typename Value>
class KeptFile {
 public:
  using Parse = std::function<absl::StatusOr<Value>(const std::string& text)>;

  static absl::StatusOr<std::unique_ptr<KeptFile>> Open(const std::string& path, Parse parse);

  std::shared_ptr<const Value> Current();

 private:
  KeptFile(std::string path, Parse parse) : path_(std::move(path)), parse_(std::move(parse)) {}
  absl::Status Read();

  const std::string path_;
  const Parse parse_;
  std::mutex mutex_;
  std::shared_ptr<const Value> value_;
  std::optional<base::FileStamp> stamp_;
};

// Logs that the file at `path` has been read again, or why not.
void TellOfReload(const std::string& path, const absl::Status& status);

template <typename Value>
absl::StatusOr<std::unique_ptr<KeptFile<Value>>> KeptFile<Value>::Open(const std::string& path,
                                                                       Parse parse) {
  std::unique_ptr<KeptFile> file(new KeptFile(path, std::move(parse)));
  if (absl::Status status = file->Read(); !status.ok()) return status;
  return file;
}

template <typename Value>
std::shared_ptr<const Value> KeptFile<Value>::Current() {
  const std::lock_guard lock(mutex_);
  // A look at every call, which costs a microsecond, so that a token that was taken away is
  // refused from then on.
  const std::optional<base::FileStamp> stamp = base::StampOf(path_);
  if (stamp != stamp_) TellOfReload(path_, Read());
  return value_;
}

template <typename Value>
absl::Status KeptFile<Value>::Read() {
  // Before reading, so that a change meanwhile is seen by the next look.
  stamp_ = base::StampOf(path_);
  const absl::StatusOr<std::string> text = ReadSecretFile(path_);
  if (!text.ok()) return text.status();
  absl::StatusOr<Value> value = parse_(*text);
  if (!value.ok()) return value.status();
  value_ = std::make_shared<const Value>(*std::move(value));
  return absl::OkStatus();
}

}  // namespace thunderhead::access
