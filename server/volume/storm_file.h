// One file of a storm, of whichever kind it is (WRF output, CF): what a catalogue of storms needs
// to know of it, and its reading.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "volume/cf_metadata.h"
#include "volume/hydrometeor_fields.h"
#include "volume/vertical_remap.h"
#include "volume/wrf_metadata.h"

namespace thunderhead::volume {

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
  std::variant<WrfMetadata, CfMetadata> metadata;
};

// Finds out what kind of file is at `path` and whether it is fit to be read. Errors name the file,
// the variable and what it lacks.
absl::StatusOr<StormFile> ReadStormFile(const std::string& path);

// Reads one record; `grid`, `checkpoint` and errors as for ReadWrfTime.
absl::StatusOr<HydrometeorFields> ReadTime(
    const StormFile& file, std::size_t record, const std::optional<VerticalGrid>& grid,
    const std::function<absl::Status(double share)>& checkpoint);

// The height grid that a storm whose first time is this record has.
absl::StatusOr<VerticalGrid> ReadVerticalGrid(const StormFile& file, std::size_t record);

}  // namespace thunderhead::volume
