#include "storm_files/cf_height_array.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "storm_files/cell_methods.h"
#include "storm_files/cf_axes.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

// The gravity by which geopotential is divided to get geopotential height.
constexpr double kGeopotentialGravity_m_per_s2 = 9.80665;
// Two numbers of levels are equal if they differ by less than this.
constexpr double kSameNumber = 1e-6;

// The kind of heights in an array, by its name.
enum class Kind {
  kNone,     // no heights of layers
  kUnknown,  // the number of levels decides whether they are faces or middles
  kMiddles,
  kHalfLevels,  // faces, numbered as in COSMO and ICON
};

Kind KindOf(const CfDescription& variable) {
  const std::string& standard = variable.standard_name;
  const std::string name = absl::AsciiStrToLower(variable.name);
  if (standard == "geometric_height_at_half_level_center") return Kind::kHalfLevels;
  if (standard == "geometric_height_at_full_level_center") return Kind::kMiddles;
  const bool is_height =
      standard.empty() ||
      OneOf(standard, {"altitude", "height", "height_above_mean_sea_level",
                       "height_above_reference_ellipsoid", "geopotential_height", "geopotential",
                       "height_above_geopotential_datum", "geometric_height_at_cell_center"});
  if (!is_height) return Kind::kNone;
  if (OneOf(name, {"hhl", "z_ifc"})) return Kind::kHalfLevels;
  if (OneOf(name, {"hfl", "z_mc"})) return Kind::kMiddles;
  if (!standard.empty()) return Kind::kUnknown;
  return OneOf(name, {"zhval", "zghalf", "zgfull", "zg", "zgeo", "altitude", "alt", "height",
                      "geopotential_height", "geopotential", "zgrid", "zh"})
             ? Kind::kUnknown
             : Kind::kNone;
}

// Returns the dimension of an array that is neither x, y nor time, if it has exactly one.
std::optional<CfDimension> LevelsOf(const netcdf::NetcdfFile& file, const std::string& array,
                                    const CfDimensions& on) {
  const auto names = file.Dimensions(array);
  const auto shape = file.Shape(array);
  std::optional<CfDimension> found;
  if (!names.ok() || !shape.ok()) return found;
  for (std::size_t i = 0; i < names->size(); ++i) {
    const std::string& name = (*names)[i];
    if (name == on.axes[0].name || name == on.axes[1].name || name == on.time) continue;
    if (name == on.member) continue;
    if ((*shape)[i] == 1 && name != on.axes[2].name) continue;
    if (found.has_value()) return std::nullopt;
    found = CfDimension{name, file.HasVariable(name) ? name : "", (*shape)[i]};
  }
  return found;
}

// Returns whether numbers rise or fall by 1 from each to the next.
bool AreConsecutive(const std::vector<double>& numbers) {
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    const double step = numbers[i] - numbers[i - 1];
    if (std::abs(std::abs(step) - 1.0) > kSameNumber) return false;
    if (step * (numbers[1] - numbers[0]) < 0.0) return false;
  }
  return !numbers.empty();
}

// Returns the numbers of levels in a dimension's coordinate, in the file's order. They are empty if
// it has none.
std::vector<double> NumbersOf(const netcdf::NetcdfFile& file, const CfDimension& levels) {
  if (levels.coordinate.empty() || !CountsLevels(DescribeCf(file, levels.coordinate))) return {};
  auto numbers = file.ReadDoubles(levels.coordinate);
  if (!numbers.ok() || numbers->size() != levels.length || !AreConsecutive(*numbers)) return {};
  return *std::move(numbers);
}

// Returns the numbers of the half levels around layers: those of the coordinate's bounds, or k and
// k + 1 around the level k. A layer that is numbered k + 1/2 is also between k and k + 1.
std::vector<double> HalfLevelsAround(const netcdf::NetcdfFile& file, const CfDimension& layers,
                                     const std::vector<double>& numbers) {
  const auto bounds = ReadBounds(file, layers.coordinate, layers.length, 0.0);
  if (bounds.ok() && AreConsecutive(*bounds)) return *bounds;
  const bool falls = numbers.size() > 1 && numbers[1] < numbers[0];
  const double first = std::floor(numbers.front() + kSameNumber) + (falls ? 1.0 : 0.0);
  std::vector<double> half_levels;
  for (std::size_t i = 0; i <= numbers.size(); ++i) {
    const auto step = static_cast<double>(i);
    half_levels.push_back(falls ? first - step : first + step);
  }
  return half_levels;
}

// Returns the index of the first of the `wanted` numbers among `all`, if they follow one another
// there in the same order.
std::optional<std::size_t> IndexIn(const std::vector<double>& all,
                                   const std::vector<double>& wanted) {
  const auto is_same = [](double a, double b) { return std::abs(a - b) < kSameNumber; };
  const auto at = std::search(all.begin(), all.end(), wanted.begin(), wanted.end(), is_same);
  if (wanted.empty() || at == all.end()) return std::nullopt;
  return static_cast<std::size_t>(at - all.begin());
}

std::string RangeText(const std::vector<double>& numbers) {
  return absl::StrCat(numbers.front(), " to ", numbers.back());
}

// Matches the levels of one array to the layers.
class Match {
 public:
  Match(const netcdf::NetcdfFile& file, const CfDimensions& dimensions,
        const netcdf::NetcdfFile& fields, std::string array, CfDimension levels, Kind kind)
      : file_(file),
        fields_(fields),
        layers_(dimensions.axes[2]),
        array_(std::move(array)),
        levels_(std::move(levels)),
        kind_(kind),
        of_layers_(NumbersOf(fields, layers_)),
        of_levels_(NumbersOf(file, levels_)) {
    has_faces_ = kind == Kind::kHalfLevels ||
                 (kind == Kind::kUnknown && levels_.length == layers_.length + 1);
  }

  // Returns the index of the array's level that belongs to the first layer. An error says why there
  // is none.
  absl::StatusOr<std::size_t> First();

  // Returns whether the array has the faces of layers, not their middles.
  bool HasFaces() const { return has_faces_; }
  const std::vector<std::string>& Assumptions() const { return assumptions_; }

 private:
  absl::StatusOr<std::size_t> ByPosition();
  bool NumbersFacesOtherwise(const std::vector<double>& wanted) const;
  absl::Status Unread(const std::string& why) const {
    return absl::InvalidArgumentError(
        absl::StrCat(file_.Path(), ": the heights of the layers cannot be taken from ", array_,
                     ", because ", why));
  }
  std::string LevelWord() const { return has_faces_ ? "half levels" : "levels"; }

  const netcdf::NetcdfFile& file_;
  const netcdf::NetcdfFile& fields_;
  const CfDimension& layers_;
  const std::string array_;
  const CfDimension levels_;
  const Kind kind_;
  const std::vector<double> of_layers_;
  const std::vector<double> of_levels_;
  bool has_faces_ = false;
  std::vector<std::string> assumptions_;
};

absl::StatusOr<std::size_t> Match::First() {
  if (&file_ == &fields_ && levels_.name == layers_.name) {
    if (!has_faces_) return 0;
    return Unread(absl::StrCat("it has only ", levels_.length, " half levels, on ", levels_.name,
                               ", where ", layers_.length, " layers need ", layers_.length + 1,
                               "; give all half levels, on a dimension of their own"));
  }
  if (kind_ == Kind::kUnknown && !has_faces_) {
    return Unread(absl::StrCat("it has ", levels_.length, " values (", levels_.name, ") for ",
                               layers_.length, " layers (", layers_.name,
                               "), and its name does not say whether these are half levels; put it "
                               "on the dimension of the layers"));
  }
  if (of_layers_.empty() || of_levels_.empty()) return ByPosition();
  const std::vector<double> wanted =
      has_faces_ ? HalfLevelsAround(fields_, layers_, of_layers_) : of_layers_;
  if (const auto first = IndexIn(of_levels_, wanted); first.has_value()) return *first;
  if (NumbersFacesOtherwise(wanted)) return 0;
  std::vector<double> turned = wanted;
  std::ranges::reverse(turned);
  if (const auto first = IndexIn(of_levels_, turned); first.has_value()) {
    if (layers_.length == 1) return *first;
    return Unread(absl::StrCat("its ", LevelWord(), " run from ", RangeText(of_levels_), " (",
                               levels_.name, ") and the layers from ", RangeText(of_layers_), " (",
                               layers_.name,
                               "); give both the same order, for example with cdo invertlev"));
  }
  return Unread(absl::StrCat("it has the ", LevelWord(), " ", RangeText(of_levels_), " (",
                             levels_.name, ") where the layers ", RangeText(of_layers_), " (",
                             layers_.name, ") need ", RangeText(wanted),
                             "; give the missing levels"));
}

// Returns whether the array has all faces, numbered in another way than by COSMO and ICON: from 0,
// or by halves.
bool Match::NumbersFacesOtherwise(const std::vector<double>& wanted) const {
  if (!has_faces_ || levels_.length != layers_.length + 1) return false;
  if ((of_levels_.back() > of_levels_.front()) != (wanted.back() > wanted.front())) return false;
  const double first_level = std::min(of_levels_.front(), of_levels_.back());
  const double first_layer = std::min(of_layers_.front(), of_layers_.back());
  return (first_level == 0.0 && first_layer == 1.0) || first_layer - first_level == 0.5;
}

// Matches levels without numbers, which must be exactly those of the layers.
absl::StatusOr<std::size_t> Match::ByPosition() {
  const std::size_t needed = layers_.length + (has_faces_ ? 1 : 0);
  if (!has_faces_ || levels_.length != needed) {
    return Unread(absl::StrCat(
        "it has ", levels_.length, " ", LevelWord(), " (", levels_.name, ") for ", layers_.length,
        " layers (", layers_.name, "), and ", of_layers_.empty() ? layers_.name : levels_.name,
        " has no numbers of levels to match them by; keep the coordinate variables of both "
        "dimensions, or give exactly the ",
        needed, " ", LevelWord(), " of these layers"));
  }
  const bool are_all = of_layers_.empty() || std::min(of_layers_.front(), of_layers_.back()) <= 1.0;
  if (!are_all) {
    assumptions_.push_back(absl::StrCat("The ", needed, " half levels of ", array_,
                                        " have no numbers, and are taken as those of the levels ",
                                        RangeText(of_layers_), "."));
  }
  return 0;
}

// Sets the direction of the layers, from one column of the first record.
absl::Status Orient(const netcdf::NetcdfFile& file, std::size_t levels, CfHeights& heights) {
  const CfVariable& array = *heights.array;
  const auto rank = static_cast<std::size_t>(array.dimensions);
  const auto z = static_cast<std::size_t>(array.places[2]);
  std::vector<std::size_t> start(rank, 0);
  std::vector<std::size_t> count(rank, 1);
  start[z] = array.first_level;
  count[z] = levels;
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> column,
                               file.ReadPart(array.name, start, count));
  heights.reversed = column.front() > column.back();
  return absl::OkStatus();
}

// Sets the ground to the lowest of the array's `levels` half levels, unless that level is one of
// the `used` half levels of the layers.
void TakeGround(std::size_t levels, std::size_t used, CfHeights& heights) {
  const std::size_t lowest = heights.reversed ? levels - 1 : 0;
  const std::size_t first = heights.array->first_level;
  if (lowest >= first && lowest < first + used) return;
  CfVariable ground = *heights.array;
  ground.more[2] = 0;
  ground.first_level = lowest;
  heights.ground = CfColumnValue{std::move(ground), heights.scale};
}

}  // namespace

bool OneOf(std::string_view text, std::initializer_list<std::string_view> list) {
  return std::ranges::find(list, text) != list.end();
}

std::optional<double> HeightScale(const std::string& units) {
  if (HasNoUnits(units)) return std::nullopt;
  if (const auto metres = MetresIn(units); metres.has_value()) return metres;
  const auto geopotential = ConversionOf(units, "m2 s-2");
  if (!geopotential.has_value()) return std::nullopt;
  return geopotential->scale / kGeopotentialGravity_m_per_s2;
}

bool IsAboveGround(const netcdf::NetcdfFile& file, const std::string& variable,
                   const CfDescription& described) {
  if (described.standard_name == "height") return true;
  const std::string name = absl::AsciiStrToLower(file.TextOrEmpty(variable, "long_name"));
  return absl::StrContains(name, "above ground") || absl::StrContains(name, "above surface") ||
         absl::StrContains(name, "above the surface") || absl::StrContains(name, "agl");
}

bool CountsLevels(const CfDescription& coordinate) {
  return HasNoUnits(coordinate.units) || ConversionOf(coordinate.units, "1").has_value() ||
         OneOf(absl::AsciiStrToLower(coordinate.units),
               {"level", "levels", "layer", "sigma_level"});
}

std::string NameOfHalfLevels(const netcdf::NetcdfFile& file) {
  for (const std::string& name : file.Variables()) {
    const CfDescription described = DescribeCf(file, name);
    if (KindOf(described) == Kind::kHalfLevels && HeightScale(described.units).has_value()) {
      return name;
    }
  }
  return "";
}

absl::StatusOr<CfHeightArray> FindHeightArray(const netcdf::NetcdfFile& file,
                                              const CfDimensions& dimensions,
                                              const netcdf::NetcdfFile& fields) {
  CfHeightArray found;
  std::size_t levels_of_found = 0;
  for (const std::string& name : file.Variables()) {
    const CfDescription described = DescribeCf(file, name);
    const Kind kind = KindOf(described);
    const auto scale = HeightScale(described.units);
    if (kind == Kind::kNone || !scale.has_value() || HoldsNoAmount(file, name)) continue;
    const std::optional<CfDimension> levels = LevelsOf(file, name, dimensions);
    if (!levels.has_value()) continue;
    CfDimensions on = dimensions;
    on.axes[2] = *levels;
    auto array = Arrange(file, name, on);
    if (!array.ok() || array->places[0] < 0 || array->places[1] < 0 || array->places[2] < 0 ||
        array->more != std::array<int, 3>{0, 0, 0}) {
      continue;
    }
    Match match(file, dimensions, fields, name, *levels, kind);
    const absl::StatusOr<std::size_t> first = match.First();
    if (!first.ok()) {
      found.unread.Update(first.status());
      continue;
    }
    // An array of faces is preferred, because middles leave the faces to be assumed.
    if (found.heights.has_value() &&
        (found.heights->kind == CfHeightKind::kFaces || !match.HasFaces())) {
      continue;
    }
    array->more[2] = match.HasFaces() ? 1 : 0;
    array->first_level = *first;
    array->of_heights_file = &file != &fields;
    CfHeights& heights = found.heights.emplace();
    heights.kind = match.HasFaces() ? CfHeightKind::kFaces : CfHeightKind::kMiddles;
    heights.name = name;
    heights.array = *std::move(array);
    heights.scale = *scale;
    heights.above_ground = IsAboveGround(file, name, described);
    found.assumptions = match.Assumptions();
    levels_of_found = levels->length;
  }
  if (!found.heights.has_value()) return found;
  CfHeights& heights = *found.heights;
  const std::size_t used =
      dimensions.axes[2].length + static_cast<std::size_t>(heights.array->more[2]);
  THUNDERHEAD_RETURN_IF_ERROR(Orient(file, used, heights));
  if (heights.kind == CfHeightKind::kFaces) TakeGround(levels_of_found, used, heights);
  return found;
}

}  // namespace thunderhead::storm_files
