#include "storm_files/cf_parts.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "storm_files/cf_arrange.h"
#include "storm_files/cf_height_array.h"
#include "storm_files/cf_members.h"
#include "storm_files/cf_metadata.h"
#include "storm_files/cf_times.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

// Returns a text that is equal for variables on the same columns.
std::string ColumnsOf(const netcdf::NetcdfFile& file, const CfDimensions& dimensions) {
  std::string text = "columns";
  for (const std::size_t axis : {0U, 1U}) {
    const CfDimension& along = dimensions.axes[axis];
    absl::StrAppend(&text, " ", along.name, " ", along.length);
    if (along.coordinate.empty()) continue;
    const auto places = file.ReadDoubles(along.coordinate);
    if (!places.ok() || places->empty()) continue;
    absl::StrAppend(&text, absl::StrFormat(" %.5g %.5g", places->front(), places->back()));
  }
  return absl::StrCat(text, " ", file.TextOrEmpty("", "uuidOfHGrid"));
}

// Returns the dimensions of the first hydrometeor that has them all.
std::optional<std::pair<std::string, CfDimensions>> FieldOf(const netcdf::NetcdfFile& file) {
  for (const std::string& name : file.Variables()) {
    if (!QuantityOf(DescribeCf(file, name)).has_value()) continue;
    auto dimensions = FindDimensions(file, name);
    if (dimensions.ok()) return std::pair(name, *std::move(dimensions));
  }
  return std::nullopt;
}

// Returns whether the levels are numbers, or have no coordinate at all.
bool AreNumbered(const netcdf::NetcdfFile& file, const CfDimension& levels) {
  return levels.coordinate.empty() || CountsLevels(DescribeCf(file, levels.coordinate));
}

// Returns the part, or one for each member of an ensemble.
std::optional<StormFile> WithMembers(const netcdf::NetcdfFile& file, const CfDimensions& dimensions,
                                     StormFile part) {
  if (dimensions.member.empty()) return part;
  const auto names = MemberNames(file, dimensions.member, dimensions.members);
  if (!names.ok()) return std::nullopt;
  std::vector<StormFile> others;
  for (std::size_t member = 1; member < names->size(); ++member) {
    others.push_back(part);
    others.back().member = (*names)[member];
  }
  part.member = names->front();
  part.others = std::move(others);
  return part;
}

}  // namespace

bool HasOnlyHeights(const netcdf::NetcdfFile& file) {
  return !NameOfHalfLevels(file).empty() && !LooksLikeCf(file);
}

std::optional<StormFile> PartOfCf(const netcdf::NetcdfFile& file) {
  if (!LoadUnits().ok()) return std::nullopt;
  StormFile part;
  part.path = file.Path();
  const std::string heights = NameOfHalfLevels(file);
  if (HasOnlyHeights(file)) {
    const auto dimensions = FindDimensions(file, heights);
    if (!dimensions.ok()) return std::nullopt;
    part.part = {ColumnsOf(file, *dimensions), true};
    return part;
  }
  const auto field = FieldOf(file);
  if (!heights.empty() || !field.has_value() || !AreNumbered(file, field->second.axes[2])) {
    return std::nullopt;
  }
  const auto times = ReadCfTimes(file, field->first, field->second.time);
  if (!times.ok() || times->times.size() != 1) return std::nullopt;
  part.times = times->times;
  part.part = {ColumnsOf(file, field->second), false};
  return WithMembers(file, field->second, std::move(part));
}

}  // namespace thunderhead::storm_files
