#include "service/cloud_folder.h"

#include <chrono>
#include <filesystem>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/status.h"

namespace thunderhead::service {
namespace {

namespace fs = std::filesystem;

// A cloud of a preset takes up to a few megabytes.
constexpr std::size_t kMostClouds = 64;

constexpr std::chrono::seconds kOneCloud{3};
// Somebody must delete one first.
constexpr std::chrono::minutes kRetryWhenFull{1};

absl::Status TooManyClouds() {
  return base::WithDetails(
      absl::ResourceExhaustedError(
          absl::StrCat("this server holds its most clouds, ", kMostClouds,
                       "; delete some, or make more with `thunderhead generate`")),
      {.reason = "TOO_MANY_CLOUDS",
       .metadata = {{"maximum", absl::StrCat(kMostClouds)}, {"unit", "clouds"}},
       .retry_after = kRetryWhenFull});
}

bool LiesIn(const std::string& folder, const std::string& file) {
  std::error_code error;
  return fs::equivalent(fs::path(file).parent_path(), folder, error) && !error;
}

}  // namespace

CloudFolder::CloudFolder(std::string path, volume::StormStore& store)
    : path_(std::move(path)), store_(store) {
  if (path_.empty()) return;
  for (const volume::StormInfo* storm : store_.Storms()) {
    if (storm->files.size() != 1 || !LiesIn(path_, storm->files[0])) continue;
    if (clouds::IsGenerated(storm->files[0])) files_[storm->id] = storm->files[0];
  }
}

absl::StatusOr<const volume::StormInfo*> CloudFolder::Make(const clouds::CloudShape& shape,
                                                           const clouds::CloudOrigin& origin,
                                                           const clouds::GenerateObserver& observer,
                                                           const std::stop_token& stop) {
  if (path_.empty()) {
    return base::WithDetails(
        absl::FailedPreconditionError(
            "this server has no folder for clouds; start it with --clouds FOLDER"),
        {.reason = "NO_CLOUDS_FOLDER"});
  }
  const std::unique_lock lock(making_, std::try_to_lock);
  if (!lock.owns_lock()) {
    return base::WithDetails(
        absl::UnavailableError("another cloud is being made; try again in a few seconds"),
        {.reason = "CLOUD_BEING_MADE", .retry_after = kOneCloud});
  }
  std::string path;
  {
    const std::lock_guard files(mutex_);
    if (files_.size() >= kMostClouds) {
      return TooManyClouds();
    }
    path = NewPath(origin);
  }
  THUNDERHEAD_RETURN_IF_ERROR(clouds::WriteGenerated(shape, origin, path, observer, stop));
  THUNDERHEAD_ASSIGN_OR_RETURN(const volume::StormInfo* storm, store_.Add(path));
  const std::lock_guard files(mutex_);
  files_[storm->id] = path;
  used_ids_.insert(storm->id);
  return storm;
}

bool CloudFolder::Holds(const std::string& storm_id) const {
  const std::lock_guard lock(mutex_);
  return files_.contains(storm_id);
}

absl::Status CloudFolder::Delete(const std::string& storm_id) {
  const std::lock_guard lock(mutex_);
  const auto file = files_.find(storm_id);
  if (file == files_.end()) {
    if (store_.Find(storm_id) == nullptr) {
      return base::WithDetails(
          absl::NotFoundError(absl::StrCat("no storm has the id '", storm_id, "'")),
          {.reason = "STORM_NOT_FOUND", .metadata = {{"storm_id", storm_id}}});
    }
    return base::WithDetails(
        absl::FailedPreconditionError(
            absl::StrCat("storm '", storm_id, "' was not made by this server, which deletes only ",
                         "clouds that it made; remove its files yourself")),
        {.reason = "STORM_NOT_DELETABLE", .metadata = {{"storm_id", storm_id}}});
  }
  std::error_code error;
  fs::remove(file->second, error);
  if (error) {
    return absl::PermissionDeniedError(
        absl::StrCat("the file of the cloud '", storm_id, "' cannot be removed: ", error.message(),
                     "; check the rights of the server's folder of clouds"));
  }
  files_.erase(file);
  return store_.Remove(storm_id);
}

// A name that neither a file nor a storm has, or had.
std::string CloudFolder::NewPath(const clouds::CloudOrigin& origin) const {
  const std::string first = absl::StrCat(origin.preset, "-", origin.seed);
  std::string name = first;
  std::error_code error;
  for (int i = 2; store_.Find(name) != nullptr || used_ids_.contains(name) ||
                  fs::exists(fs::path(path_) / (name + ".nc"), error);
       ++i) {
    name = absl::StrCat(first, "-", i);
  }
  return fs::path(path_) / (name + ".nc");
}

}  // namespace thunderhead::service
