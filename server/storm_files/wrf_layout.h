// Finds how the variables of a WRF output file are laid out: their dimensions and whether they have
// time. Programs that process WRF output rename dimensions and drop time. A dimension without WRF's
// name is therefore found by its position in WRF's variables.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "volume/grid.h"

namespace thunderhead::storm_files {

// A unit as UDUNITS spells it. A file's unit is accepted if it is the same in any spelling.
struct WrfUnit {
  const char* name;
};

inline constexpr WrfUnit kWrfLength = {"m"};

// The number of dimensions without time of a variable in layers, and of one with a value for each
// column.
inline constexpr std::size_t kRankOfLayers = 3;
inline constexpr std::size_t kRankOfColumns = 2;

// Returns whether the variable's unit is `unit` or absent.
bool HasUnits(const netcdf::NetcdfFile& file, const std::string& variable, const WrfUnit& unit);

// Returns INVALID_ARGUMENT, naming the variable and both units, if the variable has another unit.
absl::Status CheckUnits(const netcdf::NetcdfFile& file, const std::string& variable,
                        const WrfUnit& unit);

struct WrfLayout {
  glm::ivec3 cells{0};      // west-east, south-north, bottom-top
  std::size_t records = 1;  // 1 if the variables have no time
  std::string time;         // the dimension of time; empty if the variables have none
  std::string levels;       // the dimension of the layers

  // Each function returns the lengths of a variable's dimensions without time, slowest first.
  std::vector<std::size_t> Columns() const;
  std::vector<std::size_t> Layers() const;
  std::vector<std::size_t> Interfaces() const;
};

// Finds the layout of an open file. Returns INVALID_ARGUMENT, which names the dimension, if one is
// missing.
absl::StatusOr<WrfLayout> FindWrfLayout(const netcdf::NetcdfFile& file);

// Says whether a variable may change with time.
enum class Changes {
  kAtEachTime,  // the variable has time if the file has several times
  kNever,       // the variable may have no time, for example the height of the ground
};

// Checks that the file has the variable, its dimensions and its unit. `shape` are the dimensions'
// lengths without time.
absl::Status CheckVariable(const netcdf::NetcdfFile& file, const WrfLayout& layout,
                           const std::string& variable, const std::vector<std::size_t>& shape,
                           const WrfUnit& unit, Changes changes);

// Returns whether the variable has these dimensions, with time or, as `changes` says, without.
bool HasShape(const netcdf::NetcdfFile& file, const WrfLayout& layout, const std::string& variable,
              const std::vector<std::size_t>& shape, Changes changes);

// Returns the number of values that one time of the variable has. `rank` is the number of its
// dimensions without time.
absl::StatusOr<std::size_t> ValuesOfTime(const netcdf::NetcdfFile& file,
                                         const std::string& variable, std::size_t rank);

// Reads one time of a variable. A variable without time has the same values at all times, and so
// has a variable that never changes and has only one time. `huge` says what a huge value means
// (netcdf::HugeValue). It has no effect on a variable without time.
absl::Status ReadTime(const netcdf::NetcdfFile& file, const std::string& variable, std::size_t rank,
                      std::size_t record, Changes changes, std::vector<float>& values,
                      netcdf::HugeValue huge = netcdf::HugeValue::kRefused);

// Returns `shape` as text for errors.
std::string AsText(const std::vector<std::size_t>& shape);

}  // namespace thunderhead::storm_files
