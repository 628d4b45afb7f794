#include "storm_files/cf_members.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "absl/strings/ascii.h"
#include "base/status.h"
#include "storm_files/grib_parts.h"
#include "storm_files/storm_file.h"

namespace thunderhead::storm_files {
namespace {

constexpr double kMostNumber = 99999.0;

// Returns the coordinate that numbers the members along a dimension, or an empty text.
std::string MemberCoordinate(const netcdf::NetcdfFile& file, const std::string& dimension) {
  for (const std::string& name : file.Variables()) {
    const auto on = file.Dimensions(name);
    if (!on.ok() || *on != std::vector<std::string>{dimension}) continue;
    if (file.TextOrEmpty(name, "standard_name") == "realization") return name;
  }
  return file.HasVariable(dimension) ? dimension : "";
}

// Returns the members' numbers if the coordinate has usable ones, or nothing.
std::vector<int> WrittenNumbers(const netcdf::NetcdfFile& file, const std::string& coordinate,
                                std::size_t count) {
  if (coordinate.empty()) return {};
  const auto values = file.ReadDoubles(coordinate);
  if (!values.ok() || values->size() != count) return {};
  std::vector<int> numbers;
  for (const double value : *values) {
    if (!(value >= 0.0 && value <= kMostNumber && value == std::floor(value))) return {};
    numbers.push_back(static_cast<int>(value));
  }
  const std::set<int> different(numbers.begin(), numbers.end());
  return different.size() == count ? numbers : std::vector<int>();
}

}  // namespace

bool IsMemberDimension(const netcdf::NetcdfFile& file, const std::string& dimension) {
  const std::string name = absl::AsciiStrToLower(dimension);
  for (const char* known : {"realization", "member", "ensemble", "ensemble_member"}) {
    if (name == known) return true;
  }
  const std::string coordinate = MemberCoordinate(file, dimension);
  return !coordinate.empty() && file.TextOrEmpty(coordinate, "standard_name") == "realization";
}

absl::StatusOr<std::vector<std::string>> MemberNames(const netcdf::NetcdfFile& file,
                                                     const std::string& dimension,
                                                     std::size_t count) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckStormCount(file.Path(), count));
  std::vector<int> numbers = WrittenNumbers(file, MemberCoordinate(file, dimension), count);
  while (numbers.size() < count) numbers.push_back(static_cast<int>(numbers.size()));
  std::vector<std::string> names;
  names.reserve(numbers.size());
  for (const int number : numbers) names.push_back(GribMemberOf(number));
  return names;
}

}  // namespace thunderhead::storm_files
