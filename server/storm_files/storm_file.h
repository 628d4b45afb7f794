// One file of a storm, whatever its format: its description, as a catalogue of storms needs it, and
// the reader of its records.
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
#include "storm_files/vertical_remap.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

// Called before each variable with the share done so far, 0 to 1; an error ends the reading with
// that error. May be empty.
using ReadCheckpoint = std::function<absl::Status(double share)>;

// Reads the records of one file that its format has described. Holds no open file between calls;
// safe to call from any thread. Errors name the file, the variable and what to do; there is never
// half a result.
class RecordReader {
 public:
  virtual ~RecordReader() = default;

  // Reads record `record`. `grid` is the storm's height grid, chosen from this record if absent; a
  // format whose heights are the same at all times need not look at it.
  virtual absl::StatusOr<volume::HydrometeorFields> Read(
      std::size_t record, const std::optional<VerticalGrid>& grid,
      const ReadCheckpoint& checkpoint) const = 0;

  // The height grid of a storm whose first time is this record.
  virtual absl::StatusOr<VerticalGrid> ReadVerticalGrid(std::size_t record) const = 0;
};

// The most times that a file may have.
inline constexpr std::size_t kMaxTimes = 1'000'000;

// INVALID_ARGUMENT if the file at `path` has more records than that. Called before they are read.
absl::Status CheckRecords(const std::string& path, std::size_t records);

struct StormFile {
  std::string path;
  glm::ivec3 cells{0};  // west-east, south-north, bottom-top
  double dx_m = 0.0;
  double dy_m = 0.0;
  std::vector<absl::Time> times;             // of each record of the file, in the file's order
  std::vector<physics::Hydrometeor> fields;  // in the order of physics::kHydrometeors
  std::string about;                         // for people, e.g. "WRF V4.7.1, idealised"
  int domain = 1;                            // of nested grids, counted from 1
  std::string run;                           // files of different runs differ in it
  std::optional<double> latitude_deg;        // of the middle
  std::optional<double> longitude_deg;
  std::string projection;  // of the grid, as PROJ writes it; empty if it has none
  std::shared_ptr<const RecordReader> reader;
  // Another one if another file took its place, or it was written anew; the same while it only gets
  // more times.
  std::uint64_t version = 0;
  // Which file was described (base::FileStamp::Id), where somebody watches its path; 0 elsewhere.
  std::uint64_t id = 0;
  // The device that it was on when it was described (base::FileStamp::device); 0: unknown.
  std::uint64_t device = 0;
};

}  // namespace thunderhead::storm_files
