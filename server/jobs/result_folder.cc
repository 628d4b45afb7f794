#include "jobs/result_folder.h"

#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/slow_calls.h"
#include "base/status.h"
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

// Returns whether there is a folder at the path that is not a link to one. A link in place of a
// job's folder would lead to files that are not results.
bool IsOwnFolder(const fs::path& path) {
  std::error_code error;
  return fs::symlink_status(path, error).type() == fs::file_type::directory;
}

}  // namespace

absl::StatusOr<ResultFolder> ResultFolder::Open(const std::string& path,
                                                std::chrono::milliseconds patience,
                                                const base::TimeSource& time,
                                                WriteFile write_file) {
  const base::SlowCall slow(path);
  std::error_code error;
  const bool is_there = fs::is_directory(path, error);
  if (!is_there) {
    fs::create_directories(path, error);
    if (!error) fs::permissions(path, fs::perms::owner_all, error);
  }
  if (!error) return ResultFolder(path, patience, time, std::move(write_file));
  return absl::InvalidArgumentError(absl::StrCat(
      "'", path,
      "' for results of render jobs is not a folder and cannot be created: ", error.message()));
}

absl::Status ResultFolder::Write(const std::string& job_id, std::size_t place,
                                 std::shared_ptr<const DrawnPicture> picture) const {
  const std::string path = PathOf(job_id, place, picture->extension);
  return calls_->Ask(
      path_,
      [folder = path_, job = absl::StrCat(path_, "/", job_id),
       about_path = AboutPathOf(job_id, place), path, write_file = write_file_,
       picture = std::move(picture)]() -> absl::Status {
        const base::SlowCall slow(folder);
        std::error_code error;
        fs::create_directory(job, error);
        if (!IsOwnFolder(job)) {
          if (error) {
            return base::WriteProblem(
                absl::StrCat(job, " cannot be created (", error.message(),
                             "); check that its folder exists, may be written to and has room"),
                error.value());
          }
          return absl::FailedPreconditionError(
              absl::StrCat(job, " is a link; results are written only to a folder: remove it"));
        }
        THUNDERHEAD_RETURN_IF_ERROR(write_file(about_path, picture->about));
        return write_file(path, picture->bytes);
      });
}

std::string ResultFolder::PathOf(const std::string& job_id, std::size_t place,
                                 const std::string& extension) const {
  return absl::StrFormat("%s/%s/%06d.%s", path_, job_id, place, extension);
}

std::string ResultFolder::AboutPathOf(const std::string& job_id, std::size_t place) const {
  return PathOf(job_id, place, "about");
}

void ResultFolder::Remove(const std::string& job_id, std::size_t place,
                          const std::string& extension) {
  RemoveAll({PathOf(job_id, place, extension), AboutPathOf(job_id, place)});
}

void ResultFolder::Remove(const std::string& job_id) {
  if (!IsJobId(job_id)) return;
  RemoveAll({absl::StrCat(path_, "/", job_id)});
}

void ResultFolder::RemoveAll(const std::vector<std::string>& paths) {
  removed_.insert(removed_.end(), paths.begin(), paths.end());
  const absl::Status removed = calls_->Run(path_, [paths = removed_, folder = path_] {
    const base::SlowCall slow(folder);
    std::error_code ignored;
    for (const std::string& text : paths) {
      const fs::path path(text);
      // A link in place of a job's folder is removed. Files to which it leads are not.
      const bool is_job = IsJobId(path.filename().string());
      if (is_job || IsOwnFolder(path.parent_path())) fs::remove_all(path, ignored);
    }
  });
  if (removed.ok()) removed_.clear();
}

void ResultFolder::Clean(const std::set<std::string>& known) const {
  const base::SlowCall slow(path_);
  std::error_code ignored;
  for (const fs::path& job : EntriesOf(path_)) {
    // Entries other than job folders must not be removed.
    if (!IsJobId(job.filename().string())) continue;
    if (!known.contains(job.filename().string())) {
      fs::remove_all(job, ignored);
      continue;
    }
    if (!IsOwnFolder(job)) continue;
    for (const fs::path& file : EntriesOf(job)) {
      if (file.extension() == ".partial") fs::remove(file, ignored);
    }
  }
}

}  // namespace thunderhead::jobs
