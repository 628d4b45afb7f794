// One file of a storm, whatever its format: the description that a catalogue of storms needs, and
// the reader of the file's records.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "storm_files/calendar.h"
#include "storm_files/record_part.h"
#include "storm_files/vertical_remap.h"
#include "volume/hydrometeor_fields.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {

// A function that a reader calls before it reads each variable. `share` is the part of the work
// done so far, 0 to 1. If the function returns an error, the reading stops with that error. The
// function may be empty.
using ReadCheckpoint = std::function<absl::Status(double share)>;

// Reads the records of one file that its format has described. It keeps no file open between calls,
// and is safe to call from any thread. Errors name the file, the variable and what to do. Each
// function returns a complete result or an error.
class RecordReader {
 public:
  virtual ~RecordReader() = default;

  // Reads a part of a record. `grid` is the storm's height grid. If it is absent, the reader
  // chooses a grid from this part. A format whose heights are the same at all times can ignore
  // `grid`. The fields lie where they are in the whole storm. Returns INVALID_ARGUMENT if the storm
  // has no such part.
  virtual absl::StatusOr<volume::HydrometeorFields> Read(
      const RecordPart& part, const std::optional<VerticalGrid>& grid,
      const ReadCheckpoint& checkpoint) const = 0;

  // Returns the height grid of a storm whose first time is this record.
  virtual absl::StatusOr<VerticalGrid> ReadVerticalGrid(std::size_t record) const = 0;
};

// Maximum number of times in a file and in a storm. DescribeStorm lists all times of a storm, with
// about 70 bytes each, so its answer has at most about 7 MB.
inline constexpr std::size_t kMaxTimes = 100'000;

// Returns INVALID_ARGUMENT, naming the file `path`, if `records` exceeds kMaxTimes. A format calls
// this function before it reads the file's times.
absl::Status CheckRecords(const std::string& path, std::size_t records);

// The part that a file contributes to a storm, if a time of the storm is spread over several files.
struct StormPart {
  // A text that is equal for all files of one run on one grid, and different for other files. It is
  // empty if the file is a complete storm.
  std::string of;
  // True if the file belongs to every time of the run, for example with the heights of the layers.
  // Then StormFile::times is empty.
  bool at_all_times = false;
};

struct StormFile {
  std::string path;
  glm::ivec3 cells{0};  // west-east, south-north, bottom-top
  // Distances between columns at the first record. Those of other records of a domain that moves
  // can differ.
  double dx_m = 0.0;
  double dy_m = 0.0;
  // A text that is equal for all files whose columns belong to one grid, even if that grid moves.
  // If it is empty, the columns' number and distances decide.
  std::string grid;
  std::vector<absl::Time> times;             // one for each record, in the file's order
  std::vector<physics::Hydrometeor> fields;  // in the order of physics::kHydrometeors
  std::string about;                         // short description for users, e.g. "WRF V4.7.1,
                                             // idealised"
  int domain = 1;                            // number of the nested grid, counted from 1
  std::string run;                           // text that is the same for all files of one run, and
                                             // different for other runs
  std::optional<absl::Time> run_start;       // when the model run began, if the file says so
  // The calendar of the dates of `times` and `run_start`. Durations between them are counted in
  // this calendar.
  Calendar calendar = Calendar::kGregorian;
  std::optional<double> latitude_deg;  // latitude of the middle of the domain
  std::optional<double> longitude_deg;
  // The middle of the domain at each record, if the domain moves (a moving nest). Otherwise empty.
  std::vector<volume::EarthPlace> middles;
  std::string projection;  // the grid's projection, as PROJ writes it; empty if none
  // The projection at each record, if the domain moves. Otherwise empty.
  std::vector<std::string> projections;
  std::string member;  // the ensemble member, e.g. "mem05"; empty if the file has only one run
  // The reader's assumptions where the file says nothing, for users. Each text is one sentence.
  std::vector<std::string> assumptions;
  // Set if the file alone is not a storm. StormFormats::DescribeTogether describes such files.
  StormPart part;
  // The paths of all files, `path` among them, if a time is spread over several. Otherwise empty.
  std::vector<std::string> parts;
  std::shared_ptr<const RecordReader> reader;
  // Other storms in the same file, such as the other members of an ensemble. StormsOf separates
  // them.
  std::vector<StormFile> others;
  // The number of records of the storms before this one in the same file.
  std::size_t first_record = 0;
  // A number that changes if another file replaces this file, or if the file is written anew. The
  // number stays the same while the file only gets more times.
  std::uint64_t version = 0;
  // The identity (base::FileStamp::Id) of the file that was described, if its path is watched.
  // Otherwise 0.
  std::uint64_t id = 0;
  // The device of the file when it was described (base::FileStamp::device). 0 means unknown.
  std::uint64_t device = 0;
  // When the file was last written (base::FileStamp::modified_ns). 0 means unknown.
  std::int64_t modified_ns = 0;
};

// Maximum number of storms in one file.
inline constexpr std::size_t kMaxStorms = 1000;

// Returns INVALID_ARGUMENT, naming the file `path`, if `storms` exceeds kMaxStorms.
absl::Status CheckStormCount(const std::string& path, std::size_t storms);

// Returns the storms of one file, each without `others`. They get the first one's `parts`,
// `version`, `id`, `device` and `modified_ns`, which describe the file, and their `first_record`.
std::vector<StormFile> StormsOf(StormFile file);

}  // namespace thunderhead::storm_files
