#include "service/cloud_folder.h"

#include <filesystem>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::service {
namespace {

// A cloud of a preset takes up to a few megabytes.
constexpr std::size_t kMostClouds = 64;

}  // namespace

absl::StatusOr<const volume::StormInfo*> CloudFolder::Make(const clouds::CloudShape& shape,
                                                           const clouds::CloudOrigin& origin,
                                                           const clouds::GenerateObserver& observer,
                                                           const std::stop_token& stop) {
  if (path_.empty()) {
    return absl::FailedPreconditionError(
        "this server has no folder for clouds; start it with --clouds FOLDER");
  }
  const std::unique_lock lock(making_, std::try_to_lock);
  if (!lock.owns_lock()) {
    return absl::UnavailableError("another cloud is being made; try again in a few seconds");
  }
  if (made_ >= kMostClouds) {
    return absl::ResourceExhaustedError(
        absl::StrCat("this server has made its most clouds, ", kMostClouds,
                     "; make more with `thunderhead generate`, or start the server again"));
  }
  const std::string path = NewPath(origin);
  THUNDERHEAD_RETURN_IF_ERROR(clouds::WriteGenerated(shape, origin, path, observer, stop));
  THUNDERHEAD_ASSIGN_OR_RETURN(const volume::StormInfo* storm, store_.Add(path));
  ++made_;
  return storm;
}

// A name that neither a file nor a storm has.
std::string CloudFolder::NewPath(const clouds::CloudOrigin& origin) const {
  const std::string first = absl::StrCat(origin.preset, "-", origin.seed);
  std::string name = first;
  std::error_code error;
  for (int i = 2; store_.Find(name) != nullptr ||
                  std::filesystem::exists(std::filesystem::path(path_) / (name + ".nc"), error);
       ++i) {
    name = absl::StrCat(first, "-", i);
  }
  return std::filesystem::path(path_) / (name + ".nc");
}

}  // namespace thunderhead::service
