#include "storm_files/wrf_layout.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

using Names = std::initializer_list<const char*>;

// Variables by whose positions a dimension is found. The first that the file has is used.
constexpr Names kInLayers = {"P",     "PB",     "T",     "QCLOUD",   "QRAIN", "QVAPOR", "QICE",
                             "QSNOW", "QGRAUP", "QHAIL", "pressure", "THM",   "T_2",    "THM_2"};
constexpr Names kAtInterfaces = {"PH", "PHB", "PH_2", "W", "W_2"};
constexpr Names kInColumns = {"HGT", "XLAT", "XLONG", "LU_INDEX", "MAPFAC_M"};

std::vector<std::size_t> WithFirst(std::size_t first, const std::vector<std::size_t>& rest) {
  std::vector<std::size_t> all = {first};
  all.insert(all.end(), rest.begin(), rest.end());
  return all;
}

bool IsNameOfTime(const std::string& dimension) {
  return dimension == "Time" || dimension == "XTIME" || dimension == "time";
}

// The dimensions of the first of `names` that the file has, slowest first.
struct Reference {
  std::string variable;
  std::vector<std::string> dimensions;
};

std::optional<Reference> FirstReference(const netcdf::NetcdfFile& file, Names names,
                                        std::size_t lowest_rank) {
  for (const char* name : names) {
    absl::StatusOr<std::vector<std::string>> dimensions = file.Dimensions(name);
    if (dimensions.ok() && dimensions->size() >= lowest_rank) {
      return Reference{name, *std::move(dimensions)};
    }
  }
  return std::nullopt;
}

absl::StatusOr<int> LengthOf(const netcdf::NetcdfFile& file, const std::string& dimension) {
  constexpr std::size_t kMax = 100'000;
  const std::size_t length = file.DimensionLength(dimension).value_or(0);
  if (length < 1 || length > kMax) {
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": dimension ", dimension, " is ",
                                                   length, "; 1 to ", kMax, " can be read"));
  }
  return static_cast<int>(length);
}

absl::Status NoDimension(const netcdf::NetcdfFile& file, const std::string& dimension) {
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": has no dimension ", dimension,
      ", and none of the variables in layers (P, PB, T, QCLOUD, ...) by which it could be found; ",
      "give a history file of the model (wrfout_...)"));
}

// Returns the name of the dimension that WRF calls `dimension`. `from_end` is its position in
// `reference`, counted from the last dimension.
absl::StatusOr<std::string> NameOfDimension(const netcdf::NetcdfFile& file,
                                            const std::string& dimension,
                                            const std::optional<Reference>& reference,
                                            std::size_t from_end) {
  if (file.DimensionLength(dimension).has_value()) return dimension;
  if (!reference.has_value() || reference->dimensions.size() <= from_end) {
    return NoDimension(file, dimension);
  }
  const std::vector<std::string>& dimensions = reference->dimensions;
  const std::string& found = dimensions[dimensions.size() - 1 - from_end];
  if (!IsNameOfTime(found)) return found;
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": has no dimension ", dimension, ": ", reference->variable,
      " has the dimensions (", absl::StrJoin(dimensions, ", "), "); extract all levels"));
}

// Finds the dimension of time, which is empty if the variables in layers have none.
std::string NameOfTime(const netcdf::NetcdfFile& file) {
  for (const Names& names : {kInLayers, kAtInterfaces}) {
    const std::optional<Reference> reference = FirstReference(file, names, kRankOfLayers);
    if (!reference.has_value()) continue;
    if (reference->dimensions.size() > kRankOfLayers) return reference->dimensions.front();
    return "";
  }
  return file.DimensionLength("Time").has_value() ? "Time" : "";
}

}  // namespace

bool HasUnits(const netcdf::NetcdfFile& file, const std::string& variable, const WrfUnit& unit) {
  std::string spelling = file.TextOrEmpty(variable, "units");
  // WRF's Registry has "# kg(-1)" and "W m{-2}".
  std::erase_if(spelling,
                [](char c) { return std::string_view("#(){}").find(c) != std::string_view::npos; });
  const auto text = absl::StripAsciiWhitespace(spelling);
  if (text.empty()) return true;
  const std::optional<UnitConversion> conversion =
      ConversionOf(std::string_view(text.data(), text.size()), unit.name);
  constexpr double kRounding = 1e-9;
  return conversion.has_value() && std::abs(conversion->scale - 1.0) < kRounding &&
         conversion->offset == 0.0;
}

absl::Status CheckUnits(const netcdf::NetcdfFile& file, const std::string& variable,
                        const WrfUnit& unit) {
  if (HasUnits(file, variable, unit)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": ", variable, " has units '", file.TextOrEmpty(variable, "units"), "' where '",
      unit.name, "' is needed; convert it (and its units attribute) first"));
}

std::vector<std::size_t> WrfLayout::Columns() const {
  return {static_cast<std::size_t>(cells.y), static_cast<std::size_t>(cells.x)};
}

std::vector<std::size_t> WrfLayout::Layers() const {
  return WithFirst(static_cast<std::size_t>(cells.z), Columns());
}

std::vector<std::size_t> WrfLayout::Interfaces() const {
  return WithFirst(static_cast<std::size_t>(cells.z) + 1, Columns());
}

absl::StatusOr<WrfLayout> FindWrfLayout(const netcdf::NetcdfFile& file) {
  WrfLayout layout;
  const std::optional<Reference> layers = FirstReference(file, kInLayers, kRankOfColumns);
  const std::optional<Reference> columns =
      layers.has_value() ? layers : FirstReference(file, kInColumns, kRankOfColumns);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string x, NameOfDimension(file, "west_east", columns, 0));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string y,
                               NameOfDimension(file, "south_north", columns, 1));
  THUNDERHEAD_ASSIGN_OR_RETURN(layout.levels, NameOfDimension(file, "bottom_top", layers, 2));
  THUNDERHEAD_ASSIGN_OR_RETURN(layout.cells.x, LengthOf(file, x));
  THUNDERHEAD_ASSIGN_OR_RETURN(layout.cells.y, LengthOf(file, y));
  THUNDERHEAD_ASSIGN_OR_RETURN(layout.cells.z, LengthOf(file, layout.levels));
  layout.time = NameOfTime(file);
  if (!layout.time.empty()) layout.records = file.DimensionLength(layout.time).value_or(0);
  return layout;
}

bool HasShape(const netcdf::NetcdfFile& file, const WrfLayout& layout, const std::string& variable,
              const std::vector<std::size_t>& shape, Changes changes) {
  const absl::StatusOr<std::vector<std::size_t>> actual = file.Shape(variable);
  if (!actual.ok()) return false;
  if (*actual == WithFirst(layout.records, shape)) return true;
  const bool once = changes == Changes::kNever || layout.records == 1;
  return once && (*actual == shape || *actual == WithFirst(1, shape));
}

absl::Status CheckVariable(const netcdf::NetcdfFile& file, const WrfLayout& layout,
                           const std::string& variable, const std::vector<std::size_t>& shape,
                           const WrfUnit& unit, Changes changes) {
  if (!file.HasVariable(variable)) {
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": has no variable ", variable,
        ", which is needed; write it to the model's history output, or extract it as well"));
  }
  if (!HasShape(file, layout, variable, shape, changes)) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::size_t> actual, file.Shape(variable));
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": ", variable, " has dimensions ", AsText(actual), " where ",
                     AsText(WithFirst(layout.records, shape)), " are needed (time, ",
                     shape.size() == kRankOfLayers ? "levels, " : "", "south-north, west-east); ",
                     "give the model's own output file"));
  }
  return CheckUnits(file, variable, unit);
}

absl::StatusOr<std::size_t> ValuesOfTime(const netcdf::NetcdfFile& file,
                                         const std::string& variable, std::size_t rank) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::size_t> shape, file.Shape(variable));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::size_t values, file.RecordLength(variable));
  return shape.size() == rank ? values * shape.front() : values;
}

absl::Status ReadTime(const netcdf::NetcdfFile& file, const std::string& variable, std::size_t rank,
                      std::size_t record, Changes changes, std::vector<float>& values,
                      netcdf::HugeValue huge) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::size_t> shape, file.Shape(variable));
  if (shape.size() == rank) {
    THUNDERHEAD_ASSIGN_OR_RETURN(values,
                                 file.ReadPart(variable, std::vector<std::size_t>(rank, 0), shape));
    return absl::OkStatus();
  }
  const bool once = changes == Changes::kNever && !shape.empty() && shape.front() == 1;
  return file.ReadRecord(variable, once ? 0 : record, values, huge);
}

std::string AsText(const std::vector<std::size_t>& shape) {
  return absl::StrCat("(", absl::StrJoin(shape, ", "), ")");
}

}  // namespace thunderhead::storm_files
