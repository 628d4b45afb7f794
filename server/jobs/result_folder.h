// The folder in which drawn pictures wait to be fetched. Each job has a subfolder, with one file
// per picture and a description of it. Each file appears completely or not at all. Open and Clean
// may block. The other functions block for `patience` at most, even if the storage hangs.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/patient_calls.h"
#include "base/time_source.h"
#include "jobs/picture_source.h"

namespace thunderhead::jobs {

class ResultFolder {
 public:
  // Creates the folder, accessible only to this user. INVALID_ARGUMENT if that fails.
  static absl::StatusOr<ResultFolder> Open(const std::string& path,
                                           std::chrono::milliseconds patience,
                                           const base::TimeSource& time);

  // Writes the picture at `place` of a job and its description. Errors as in base::WriteWholeFile.
  // DEADLINE_EXCEEDED while the storage hangs; the files may still be written afterwards.
  absl::Status Write(const std::string& job_id, std::size_t place,
                     std::shared_ptr<const DrawnPicture> picture) const;

  std::string PathOf(const std::string& job_id, std::size_t place,
                     const std::string& extension) const;
  std::string AboutPathOf(const std::string& job_id, std::size_t place) const;

  // Removes the files of a picture or of a job. Missing files are not an error. Files that cannot
  // be removed because the storage hangs are removed with the next call.
  void Remove(const std::string& job_id, std::size_t place, const std::string& extension);
  void Remove(const std::string& job_id);

  // Returns how long the storage has hung; 0 if it does not hang.
  double HangingSeconds() const { return calls_->HangingSeconds(); }

  // Removes what a killed server left: partially written files, and the folders of jobs that are
  // not in `known`.
  void Clean(const std::set<std::string>& known) const;

 private:
  ResultFolder(std::string path, std::chrono::milliseconds patience, const base::TimeSource& time)
      : path_(std::move(path)), calls_(std::make_unique<base::PatientCalls>(patience, time)) {}
  void RemoveAll(const std::vector<std::string>& paths);

  std::string path_;
  std::unique_ptr<base::PatientCalls> calls_;
  std::vector<std::string> removed_;  // paths that hanging storage has kept from being removed
};

}  // namespace thunderhead::jobs
