#include "storm_files/cf_checks.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::storm_files {

absl::Status WrongUnits(const netcdf::NetcdfFile& file, const CfDescription& variable,
                        const std::string& wanted) {
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": ", variable.name,
      variable.units.empty() ? " has no units" : absl::StrCat(" has units '", variable.units, "'"),
      " where ", wanted, " is needed; convert it, or add its units attribute"));
}

std::size_t RankOf(const CfMetadata& metadata) { return metadata.dimensions.unstructured ? 2 : 3; }

bool Has(const CfMetadata& metadata, AirVariable variable) {
  return std::ranges::any_of(
      metadata.air, [variable](const CfAirField& field) { return field.air.variable == variable; });
}

bool OnAllAxes(const CfVariable& variable) {
  return std::ranges::none_of(variable.places, [](int place) { return place < 0; });
}

bool OnCells(const CfVariable& variable) { return variable.more == std::array<int, 3>{0, 0, 0}; }

absl::StatusOr<CfVariable> ArrangeOnCells(const netcdf::NetcdfFile& file,
                                          const std::string& variable, const CfMetadata& metadata) {
  THUNDERHEAD_ASSIGN_OR_RETURN(CfVariable arranged, Arrange(file, variable, metadata.dimensions));
  if (OnAllAxes(arranged) && OnCells(arranged)) return arranged;
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": ", variable, " does not lie on ", metadata.dimensions.axes[0].name, ", ",
      metadata.dimensions.axes[1].name, " and ", metadata.dimensions.axes[2].name, ", as ",
      metadata.fields.front().variable.name, " does; put all on one grid"));
}

bool LiesOnAllAxes(const netcdf::NetcdfFile& file, const std::string& variable,
                   const CfMetadata& metadata) {
  const auto arranged = Arrange(file, variable, metadata.dimensions);
  if (arranged.ok()) return OnAllAxes(*arranged);
  const auto names = file.Dimensions(variable);
  return names.ok() && std::ranges::all_of(metadata.dimensions.axes, [&](const CfDimension& axis) {
           return std::ranges::find(*names, axis.name) != names->end();
         });
}

bool HasFewerAxes(const netcdf::NetcdfFile& file, const std::string& variable,
                  const CfMetadata& metadata) {
  const auto arranged = Arrange(file, variable, metadata.dimensions);
  return arranged.ok() && !OnAllAxes(*arranged);
}

}  // namespace thunderhead::storm_files
