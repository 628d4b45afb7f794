// The folder in which drawn pictures wait to be fetched: a folder a job, in it a picture's file
// and, beside it, what is told of it. Each file appears whole or not at all. Open and Clean may
// block; of the others none does so for longer than its patience, also where the storage hangs.
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
  // Creates the folder, for this user only. INVALID_ARGUMENT if that cannot be.
  static absl::StatusOr<ResultFolder> Open(const std::string& path,
                                           std::chrono::milliseconds patience,
                                           const base::TimeSource& time);

  // The picture at `place` of a job, and what is told of it. Errors as base::WriteWholeFile; and
  // DEADLINE_EXCEEDED while the storage hangs, after which it may have been written all the same.
  absl::Status Write(const std::string& job_id, std::size_t place,
                     std::shared_ptr<const DrawnPicture> picture) const;

  std::string PathOf(const std::string& job_id, std::size_t place,
                     const std::string& extension) const;
  std::string AboutPathOf(const std::string& job_id, std::size_t place) const;

  // Removes the files of a picture or of a job; files that do not exist are no error. What cannot
  // be removed as the storage hangs is removed with the next.
  void Remove(const std::string& job_id, std::size_t place, const std::string& extension);
  void Remove(const std::string& job_id);

  // For how long the storage has hung; 0 if it does not.
  double HangingSeconds() const { return calls_->HangingSeconds(); }

  // Removes what a server left that was killed: files half written, and the folders of jobs other
  // than `known`.
  void Clean(const std::set<std::string>& known) const;

 private:
  ResultFolder(std::string path, std::chrono::milliseconds patience, const base::TimeSource& time)
      : path_(std::move(path)), calls_(std::make_unique<base::PatientCalls>(patience, time)) {}
  void RemoveAll(const std::vector<std::string>& paths);

  std::string path_;
  std::unique_ptr<base::PatientCalls> calls_;
  std::vector<std::string> removed_;  // but for the storage
};

}  // namespace thunderhead::jobs
