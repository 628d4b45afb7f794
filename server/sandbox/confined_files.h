// Describes and reads storm files, each in a separate confined process (reader). If a hostile file
// takes over its reader, crashes it or exhausts its memory, the only consequence is an error for
// this file.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/file_stamp.h"
#include "base/time_source.h"
#include "sandbox/readers.h"
#include "storm_files/storm_file.h"
#include "storm_files/storm_format.h"

namespace thunderhead::sandbox {

struct ConfinedOptions {
  ReaderLimits limits = {};
  CheckOpened check_opened = {};
  std::string program = {};                            // path of the reader program; if empty,
                                                       // ReaderProgram()
  const base::TimeSource* time = &base::SteadyTime();  // must outlive ConfinedFiles
};

class ConfinedFiles : public std::enable_shared_from_this<ConfinedFiles> {
 public:
  explicit ConfinedFiles(const ConfinedOptions& options = {});

  // Returns OK if this machine can confine a reader.
  absl::Status Probe();

  absl::StatusOr<storm_files::StormFile> Describe(const std::string& path);
  // Describes several files, each separately, by one reader. If that reader fails, a separate
  // reader describes each file. Returns ABORTED for each file that was not described within
  // `patience` (see StormFormats::DescribeEach).
  std::vector<absl::StatusOr<storm_files::StormFile>> DescribeEach(
      const std::vector<std::string>& paths,
      std::chrono::milliseconds patience = storm_files::kLongestDescription);
  // Describes the files at `paths` as one time. `path` is the first of them.
  absl::StatusOr<storm_files::StormFile> DescribeTogether(const std::string& path,
                                                          const std::vector<std::string>& paths);
  // Reads a part of a record of the file that `of` describes.
  absl::StatusOr<volume::HydrometeorFields> Read(
      const storm_files::StormFile& of, const storm_files::RecordPart& part,
      const std::optional<storm_files::VerticalGrid>& grid,
      const storm_files::ReadCheckpoint& checkpoint);
  absl::StatusOr<storm_files::VerticalGrid> ReadVerticalGrid(const storm_files::StormFile& of,
                                                             std::size_t record);

 private:
  // A file that made its reader fail. It would probably make another reader fail, too.
  struct Offender {
    base::FileStamp stamp;
    base::TimeSource::Clock::time_point when;
    absl::Status failure;
  };

  void Own(const std::string& path, const std::vector<std::string>& paths,
           storm_files::StormFile& file);

  // Sends the request to a reader. If the same unchanged file has made a reader fail recently,
  // returns that reader's error instead.
  absl::Status Run(Request request, Reply wanted, Readers::Patience patience,
                   const storm_files::ReadCheckpoint& checkpoint, const Readers::Take& take);
  // Returns ABORTED if `patience.is_trial` is true and the description takes longer than
  // `patience.time`.
  absl::StatusOr<storm_files::StormFile> DescribeFor(const std::string& path,
                                                     const std::vector<std::string>& paths,
                                                     Readers::Patience patience);
  Readers::Patience DescriptionPatience(std::chrono::milliseconds patience, bool is_batch) const;

  const ConfinedOptions options_;
  Readers readers_;
  std::mutex mutex_;
  std::map<std::string, Offender> offenders_;
};

// Returns a copy of `formats` that makes confined readers describe and read every file. The readers
// use the formats of the reader program, and not those that were added to `formats`.
storm_files::StormFormats Confined(storm_files::StormFormats formats,
                                   const std::shared_ptr<ConfinedFiles>& files);

// Returns the built-in formats, changed so that confined readers describe and read every file.
storm_files::StormFormats ConfinedFormats(const ConfinedOptions& options = {});

}  // namespace thunderhead::sandbox
