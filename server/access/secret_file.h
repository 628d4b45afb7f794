// Reads files that control access. It accepts only files that no other user of the machine could
// have written, and that not every user can read.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "base/file_stamp.h"
#include "base/storage_checks.h"
#include "base/time_source.h"

namespace thunderhead::access {

// Reads the file. Returns FAILED_PRECONDITION if it cannot be read, is not a regular file or is
// larger than 4 MiB. Returns the same error, with the command that repairs the file, in three
// cases. The file belongs neither to root nor to the server's user, its group may write it, or
// other users may read or write it.
absl::StatusOr<std::string> ReadSecretFile(const std::string& path);

// Holds the parsed contents of a file, and reads the file again when it has changed. If a changed
// file is invalid, the error is logged and the last valid contents stay in use, so that a mistake
// in the file locks no one out. The contents also stay in use while the file's storage hangs. Safe
// from any thread.
template <typename Value>
class KeptFile {
 public:
  using Parse = std::function<absl::StatusOr<Value>(const std::string& text)>;

  // Reads the file at `path`, and converts its text by `parse`. `time` measures the timeout for
  // later checks of the file, and must outlive the object.
  static absl::StatusOr<std::unique_ptr<KeptFile>> Open(
      const std::string& path, Parse parse, const base::TimeSource& time = base::SteadyTime());

  // Returns the newest valid contents, after checking whether the file has changed. Waits at most
  // base::StorageChecks::kPatience for this check.
  std::shared_ptr<const Value> Current();

 private:
  // All members except `mutex` and `value` are used only by the checking thread.
  struct State {
    absl::Status Read();
    void Look();

    const std::string path;
    const Parse parse;
    std::optional<base::FileStamp> stamp;
    std::mutex mutex;
    std::shared_ptr<const Value> value;
  };

  KeptFile(const std::shared_ptr<State>& state, const base::TimeSource& time)
      : state_(state),
        checks_(
            state->path, [state] { state->Look(); }, base::StorageChecks::kPatience, time) {}

  const std::shared_ptr<State> state_;
  base::StorageChecks checks_;
};

// Logs that the file at `path` has been read again, or why that failed.
void TellOfReload(const std::string& path, const absl::Status& status);

template <typename Value>
absl::StatusOr<std::unique_ptr<KeptFile<Value>>> KeptFile<Value>::Open(
    const std::string& path, Parse parse, const base::TimeSource& time) {
  std::shared_ptr<State> state(new State{.path = path, .parse = std::move(parse)});
  if (absl::Status status = state->Read(); !status.ok()) return status;
  return std::unique_ptr<KeptFile>(new KeptFile(state, time));
}

template <typename Value>
std::shared_ptr<const Value> KeptFile<Value>::Current() {
  // The file is checked at every call, so that a token that was removed is refused from then on.
  checks_.LookAgain();
  const std::lock_guard lock(state_->mutex);
  return state_->value;
}

template <typename Value>
void KeptFile<Value>::State::Look() {
  if (base::StampOf(path) != stamp) TellOfReload(path, Read());
}

template <typename Value>
absl::Status KeptFile<Value>::State::Read() {
  // The file's times and size (stamp) are taken before reading, so that the next check detects a
  // change that happens during the reading.
  stamp = base::StampOf(path);
  const absl::StatusOr<std::string> text = ReadSecretFile(path);
  if (!text.ok()) return text.status();
  absl::StatusOr<Value> read = parse(*text);
  if (!read.ok()) return read.status();
  const std::lock_guard lock(mutex);
  value = std::make_shared<const Value>(*std::move(read));
  return absl::OkStatus();
}

}  // namespace thunderhead::access
