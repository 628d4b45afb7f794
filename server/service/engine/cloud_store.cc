#include "service/engine/cloud_store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/status.h"

namespace thunderhead::service {
namespace {

namespace fs = std::filesystem;

// Maximum number of clouds in all and per identity. The file of a cloud takes up to a few
// megabytes.
constexpr std::size_t kMaxClouds = 64;
constexpr std::size_t kMaxCloudsEach = 32;
// Memory per grid cell while a cloud is generated: the water, and a copy of it for writing.
constexpr std::size_t kBytesPerCell = 8;

constexpr std::chrono::seconds kRetryWhenBusy{3};  // about the time to generate a cloud
// The maximum number of clouds is reached, so a retry helps only after a cloud was deleted.
constexpr std::chrono::minutes kRetryWhenFull{1};

absl::Status TooManyClouds(const char* who, std::size_t maximum) {
  return base::WithDetails(
      absl::ResourceExhaustedError(absl::StrCat(
          who, " the maximum of ", maximum, " clouds; delete some, or use `thunderhead generate`")),
      {.reason = "TOO_MANY_CLOUDS",
       .metadata = {{"maximum", absl::StrCat(maximum)}, {"unit", "clouds"}},
       .retry_after = kRetryWhenFull});
}

bool LiesIn(const std::string& folder, const std::string& file) {
  std::error_code error;
  return fs::equivalent(fs::path(file).parent_path(), folder, error) && !error;
}

}  // namespace

CloudStore::CloudStore(std::string path, storm_store::StormStore& store,
                       std::shared_ptr<base::MemoryBudget> memory)
    : path_(std::move(path)),
      store_(store),
      memory_(memory != nullptr ? std::move(memory) : base::MemoryBudget::Unlimited()) {
  if (path_.empty()) return;
  for (const storm_store::StormInfoPtr& storm : store_.Storms()) {
    if (storm->files.size() != 1 || !LiesIn(path_, storm->files[0])) continue;
    if (clouds::IsGenerated(storm->files[0])) files_[storm->id] = {storm->files[0], ""};
  }
}

absl::StatusOr<storm_store::StormInfoPtr> CloudStore::Make(const clouds::CloudShape& shape,
                                                           const clouds::CloudOrigin& origin,
                                                           const clouds::GenerateObserver& observer,
                                                           const std::stop_token& stop,
                                                           const std::string& owner) {
  if (path_.empty()) {
    return base::WithDetails(
        absl::FailedPreconditionError(
            "this server has no folder for clouds; start it with --clouds FOLDER"),
        {.reason = "NO_CLOUDS_FOLDER"});
  }
  const std::unique_lock lock(making_, std::try_to_lock);
  if (!lock.owns_lock()) {
    return base::WithDetails(
        absl::UnavailableError("another cloud is being generated; try again in a few seconds"),
        {.reason = "CLOUD_BEING_MADE", .retry_after = kRetryWhenBusy});
  }
  {
    const std::lock_guard files(mutex_);
    if (files_.size() >= kMaxClouds) return TooManyClouds("this server already has", kMaxClouds);
    const auto own = std::ranges::count_if(
        files_, [&](const auto& cloud) { return cloud.second.owner == owner; });
    if (!owner.empty() && static_cast<std::size_t>(own) >= kMaxCloudsEach) {
      return TooManyClouds("you already have", kMaxCloudsEach);
    }
  }
  THUNDERHEAD_RETURN_IF_ERROR(FolderAnswers());
  const std::string path = NewPath(origin);
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const base::MemoryReservation reserved,
      memory_->Reserve(base::MemoryUse::kReading, shape.grid.CellCount() * kBytesPerCell,
                       "a cloud that is generated"));
  THUNDERHEAD_RETURN_IF_ERROR(clouds::WriteGenerated(shape, origin, path, observer, stop));
  THUNDERHEAD_ASSIGN_OR_RETURN(storm_store::StormInfoPtr storm, store_.Add(path));
  const std::lock_guard files(mutex_);
  files_[storm->id] = {path, owner};
  used_ids_.insert(storm->id);
  return storm;
}

bool CloudStore::Holds(const std::string& storm_id) const {
  const std::lock_guard lock(mutex_);
  return files_.contains(storm_id);
}

absl::Status CloudStore::Delete(const std::string& storm_id) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string path, PathOf(storm_id));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::error_code error, Remove(path));
  if (error) {
    return absl::PermissionDeniedError(
        absl::StrCat("cannot remove the file of cloud '", storm_id, "': ", error.message(),
                     "; check the permissions of the server's folder of clouds"));
  }
  {
    const std::lock_guard lock(mutex_);
    files_.erase(storm_id);
  }
  return store_.Remove(storm_id);
}

absl::Status CloudStore::FolderAnswers() {
  return patient_.Ask(path_, [path = path_] {
    // A new file is created, because the status of an existing file may come from a cache. Only
    // whether the storage responds matters here. Other errors of the folder are reported when the
    // cloud is written.
    const std::string asked = absl::StrCat(path, "/.answers-", ::getpid());
    const int file =
        ::open(asked.c_str(), O_CREAT | O_EXCL | O_NOFOLLOW | O_WRONLY | O_CLOEXEC, S_IRUSR);
    if (file >= 0) {
      ::close(file);
      ::unlink(asked.c_str());
    }
    return absl::OkStatus();
  });
}

absl::StatusOr<std::error_code> CloudStore::Remove(const std::string& path) {
  return patient_.Ask(path_, [path]() -> absl::StatusOr<std::error_code> {
    std::error_code error;
    fs::remove(path, error);
    return error;
  });
}

absl::StatusOr<std::string> CloudStore::PathOf(const std::string& storm_id) const {
  const std::lock_guard lock(mutex_);
  const auto file = files_.find(storm_id);
  if (file == files_.end()) {
    if (store_.Find(storm_id) == nullptr) {
      return base::WithDetails(
          absl::NotFoundError(absl::StrCat("no storm has the id '", storm_id, "'")),
          {.reason = "STORM_NOT_FOUND", .metadata = {{"storm_id", storm_id}}});
    }
    return base::WithDetails(
        absl::FailedPreconditionError(absl::StrCat(
            "storm '", storm_id, "' was not generated by this server, which deletes only ",
            "clouds that it generated; remove its files yourself")),
        {.reason = "STORM_NOT_DELETABLE", .metadata = {{"storm_id", storm_id}}});
  }
  return file->second.path;
}

bool CloudStore::WasUsed(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  return used_ids_.contains(id);
}

std::string CloudStore::NewPath(const clouds::CloudOrigin& origin) const {
  const std::string first = absl::StrCat(origin.preset, "-", origin.seed);
  std::string name = first;
  std::error_code error;
  for (int i = 2; store_.Find(name) != nullptr || WasUsed(name) ||
                  fs::exists(fs::path(path_) / (name + ".nc"), error);
       ++i) {
    name = absl::StrCat(first, "-", i);
  }
  return fs::path(path_) / (name + ".nc");
}

}  // namespace thunderhead::service
