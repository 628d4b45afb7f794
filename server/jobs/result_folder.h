// The folder in which drawn pictures are kept for clients to fetch. Each job has a subfolder, with
// two files for each picture: the picture and its description. Each file appears completely or not
// at all. Open and Clean may block. The other functions block for at most `patience`, even if the
// storage hangs.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/time_source.h"
#include "base/timed_calls.h"
#include "base/whole_file.h"
#include "jobs/picture_source.h"

namespace thunderhead::jobs {

// Writes a whole file, as base::WriteWholeFile does. It may be called on any thread, also after the
// ResultFolder no longer exists.
using WriteFile = std::function<absl::Status(const std::string& path, std::string_view bytes)>;

class ResultFolder {
 public:
  // Opens the folder at `path`. If it does not exist, creates it, accessible only to this user.
  // Returns INVALID_ARGUMENT if that fails. Files are written by `write_file`.
  static absl::StatusOr<ResultFolder> Open(const std::string& path,
                                           std::chrono::milliseconds patience,
                                           const base::TimeSource& time,
                                           WriteFile write_file = &base::WriteWholeFile);

  // Writes the picture with index `place` of a job, and its description. Returns the errors of
  // base::WriteProblem, and FAILED_PRECONDITION if the job's folder is a link. Returns
  // DEADLINE_EXCEEDED while the storage hangs; the files may then still be written later.
  absl::Status Write(const std::string& job_id, std::size_t place,
                     std::shared_ptr<const DrawnPicture> picture) const;

  std::string PathOf(const std::string& job_id, std::size_t place,
                     const std::string& extension) const;
  std::string AboutPathOf(const std::string& job_id, std::size_t place) const;

  // Both functions remove files, those of one picture or of a whole job. Missing files are ignored.
  // Files that cannot be removed because the storage hangs are removed by the next call.
  void Remove(const std::string& job_id, std::size_t place, const std::string& extension);
  void Remove(const std::string& job_id);

  // Returns the time in seconds for which the storage has hung, or 0 if it does not hang.
  double HangingSeconds() const { return calls_->HangingSeconds(); }

  // Removes the files that a killed server may have left: partially written files, and the folders
  // of jobs whose ids are not in `known`.
  void Clean(const std::set<std::string>& known) const;

 private:
  ResultFolder(std::string path, std::chrono::milliseconds patience, const base::TimeSource& time,
               WriteFile write_file)
      : path_(std::move(path)),
        write_file_(std::move(write_file)),
        calls_(std::make_unique<base::TimedCalls>(patience, time)) {}
  void RemoveAll(const std::vector<std::string>& paths);

  std::string path_;
  WriteFile write_file_;
  std::unique_ptr<base::TimedCalls> calls_;
  std::vector<std::string> removed_;  // paths that are still to be removed, because the storage
                                      // hung
};

}  // namespace thunderhead::jobs
