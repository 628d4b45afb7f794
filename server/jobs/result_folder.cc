#include "jobs/result_folder.h"

#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "jobs/job_record.h"

namespace thunderhead::jobs {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> EntriesOf(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    entries.push_back(at->path());
  }
  return entries;
}

// A job's, as `Jobs` names them: nothing else in the folder is ours to remove.
bool IsJobId(const std::string& name) {
  return name.size() == kIdDigits &&
         name.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

absl::StatusOr<ResultFolder> ResultFolder::Open(const std::string& path) {
  std::error_code error;
  const bool is_there = fs::is_directory(path, error);
  if (!is_there) {
    fs::create_directories(path, error);
    if (!error) fs::permissions(path, fs::perms::owner_all, error);
  }
  if (!error) return ResultFolder(path);
  return absl::InvalidArgumentError(absl::StrCat(
      "'", path,
      "' for results of render jobs is not a folder and cannot be created: ", error.message()));
}

absl::Status ResultFolder::Write(const std::string& job_id, std::size_t place,
                                 const std::string& extension, std::string_view bytes,
                                 std::string_view about) const {
  std::error_code error;
  fs::create_directory(fs::path(path_) / job_id, error);
  THUNDERHEAD_RETURN_IF_ERROR(base::WriteWholeFile(AboutPathOf(job_id, place), about));
  return base::WriteWholeFile(PathOf(job_id, place, extension), bytes);
}

std::string ResultFolder::PathOf(const std::string& job_id, std::size_t place,
                                 const std::string& extension) const {
  return absl::StrFormat("%s/%s/%06d.%s", path_, job_id, place, extension);
}

std::string ResultFolder::AboutPathOf(const std::string& job_id, std::size_t place) const {
  return PathOf(job_id, place, "about");
}

void ResultFolder::Remove(const std::string& job_id, std::size_t place,
                          const std::string& extension) const {
  std::error_code ignored;
  fs::remove(PathOf(job_id, place, extension), ignored);
  fs::remove(AboutPathOf(job_id, place), ignored);
}

void ResultFolder::Remove(const std::string& job_id) const {
  std::error_code ignored;
  fs::remove_all(fs::path(path_) / job_id, ignored);
}

void ResultFolder::Clean(const std::set<std::string>& known) const {
  std::error_code ignored;
  for (const fs::path& job : EntriesOf(path_)) {
    if (!IsJobId(job.filename().string())) continue;
    if (!known.contains(job.filename().string())) {
      fs::remove_all(job, ignored);
      continue;
    }
    for (const fs::path& file : EntriesOf(job)) {
      if (file.extension() == ".partial") fs::remove(file, ignored);
    }
  }
}

}  // namespace thunderhead::jobs
