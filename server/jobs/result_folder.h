// The folder in which drawn pictures wait to be fetched: a folder a job, in it a picture's file
// and, beside it, what is told of it. Each file appears whole or not at all. Calls may block.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::jobs {

class ResultFolder {
 public:
  // Creates the folder, for this user only. INVALID_ARGUMENT if that cannot be.
  static absl::StatusOr<ResultFolder> Open(const std::string& path);

  // The picture at `place` of a job, and what is told of it. Errors as base::WriteWholeFile.
  absl::Status Write(const std::string& job_id, std::size_t place, const std::string& extension,
                     std::string_view bytes, std::string_view about) const;

  std::string PathOf(const std::string& job_id, std::size_t place,
                     const std::string& extension) const;
  std::string AboutPathOf(const std::string& job_id, std::size_t place) const;

  // Removes the files of a picture or of a job; files that do not exist are no error.
  void Remove(const std::string& job_id, std::size_t place, const std::string& extension) const;
  void Remove(const std::string& job_id) const;

  // Removes what a server left that was killed: files half written, and the folders of jobs other
  // than `known`.
  void Clean(const std::set<std::string>& known) const;

 private:
  explicit ResultFolder(std::string path) : path_(std::move(path)) {}

  std::string path_;
};

}  // namespace thunderhead::jobs
