#include "storm_files/cf_axes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

constexpr std::size_t kMaxCells = 100'000;
constexpr double kMetresPerKm = 1000.0;

// A relative tolerance. It is necessary because coordinates are often rounded when they are
// written, or stored as floats.
constexpr double kEvenTolerance = 1e-2;

struct WrittenAxis {
  std::vector<double> centres;  // in the file's order
  std::vector<double> faces;    // one face more than centres, from the bounds; empty if the file
                                // has no bounds
};

// Removes jumps of a whole period, such as that from 359.9 to 0 degrees.
void Unwrap(std::vector<double>& values, double period) {
  if (period == 0.0) return;
  for (std::size_t i = 1; i < values.size(); ++i) {
    values[i] -= period * std::round((values[i] - values[i - 1]) / period);
  }
}

// Returns whether the name of a coordinate is that of a longitude or latitude. The name is used
// because the units may be missing.
bool IsAngle(const CfDescription& coordinate) {
  const std::string name = absl::AsciiStrToLower(
      coordinate.standard_name.empty() ? coordinate.name : coordinate.standard_name);
  for (const char* angle : {"lon", "lat", "rlon", "rlat"}) {
    if (name == angle) return true;
  }
  return name.ends_with("longitude") || name.ends_with("latitude");
}

// Returns whether a coordinate only numbers the cells. Its unit then has no dimension, or it has no
// unit, and its values are 0, 1, 2, ... or 1, 2, 3, ...
absl::StatusOr<bool> NumbersCells(const netcdf::NetcdfFile& file, const CfDescription& coordinate) {
  if (IsAngle(coordinate)) return false;
  if (!HasNoUnits(coordinate.units)) {
    return ConversionOf(coordinate.units, "1").has_value() &&
           !ConversionOf(coordinate.units, "degree").has_value();
  }
  if (coordinate.standard_name.starts_with("projection_")) return false;
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> values, file.ReadDoubles(coordinate.name));
  if (values.size() < 2 || (values[0] != 0.0 && values[0] != 1.0)) return false;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] != values[i - 1] + 1.0) return false;
  }
  return true;
}

// Returns 1 for a coordinate that increases upwards, or -1 for a depth, which increases downwards.
absl::StatusOr<double> UpwardSign(const netcdf::NetcdfFile& file, const CfDescription& coordinate) {
  const std::string positive = absl::AsciiStrToLower(coordinate.positive);
  if (positive.empty() || positive == "up") return 1.0;
  if (positive == "down") return -1.0;
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": the coordinate ", coordinate.name, " has the attribute positive '",
      coordinate.positive, "'; it must be 'up' or 'down'"));
}

absl::Status CheckMonotonic(const netcdf::NetcdfFile& file, const std::string& dimension,
                            const std::vector<double>& rising_m) {
  for (std::size_t i = 0; i < rising_m.size(); ++i) {
    if (std::isfinite(rising_m[i]) && (i == 0 || rising_m[i] > rising_m[i - 1])) continue;
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": the coordinate ", dimension,
                                                   " neither rises nor falls all along (see value ",
                                                   i, "); write it in order"));
  }
  return absl::OkStatus();
}

// Returns whether the steps of `rising` are equal, apart from rounding.
bool IsEven(const std::vector<double>& rising) {
  const auto steps = static_cast<double>(rising.size() - 1);
  const double step = (rising.back() - rising.front()) / steps;
  for (std::size_t i = 0; i < rising.size(); ++i) {
    const double expected = rising.front() + static_cast<double>(i) * step;
    if (std::abs(rising[i] - expected) > kEvenTolerance * step) return false;
  }
  return true;
}

struct Faces {
  std::vector<double> faces_m;  // empty if no faces fit
  double max_change = 1.0;      // largest ratio of thickness between neighbouring cells
};

// Returns the faces of cells with centres `centres_m` and lowest face `low_m`. Returns none unless
// thicknesses are positive and change by at most a factor of two from cell to cell.
Faces FacesFrom(double low_m, const std::vector<double>& centres_m) {
  constexpr double kMaxChange = 2.001;
  Faces faces{{low_m}, 1.0};
  double before_m = 0.0;
  for (const double centre_m : centres_m) {
    const double thickness_m = 2.0 * (centre_m - faces.faces_m.back());
    if (!(thickness_m > 0.0)) return {};
    const double change = before_m > 0.0 ? thickness_m / before_m : 1.0;
    faces.max_change = std::max({faces.max_change, change, 1.0 / change});
    if (faces.max_change > kMaxChange) return {};
    before_m = thickness_m;
    faces.faces_m.push_back(faces.faces_m.back() + thickness_m);
  }
  return faces;
}

// Returns the faces of the only cell of an axis. Its width is `single_cell`, or else twice the
// coordinate. Adds an assumption to the axis.
absl::StatusOr<std::vector<double>> FacesOfOne(const netcdf::NetcdfFile& file, double centre,
                                               double single_cell, CfAxis& axis) {
  const std::string& coordinate = axis.coordinate;
  const double size = single_cell > 0.0 ? single_cell : 2.0 * std::abs(centre);
  if (!(size > 0.0)) {
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": ", coordinate, " has one cell at 0 and no bounds, so it has no size; add ",
        coordinate, ":bounds"));
  }
  axis.assumptions.push_back(absl::StrFormat(
      "%s has one cell and no bounds; the cell is taken to be %g %s wide%s.", coordinate, size,
      axis.unit == CfAxisUnit::kDegrees ? "degrees" : "m",
      single_cell > 0.0 ? ", like the cells along the other axis" : ", twice its coordinate"));
  return std::vector<double>{centre - 0.5 * size, centre + 0.5 * size};
}

absl::Status CheckLength(const netcdf::NetcdfFile& file, const CfDimension& dimension) {
  if (dimension.length >= 1 && dimension.length <= kMaxCells) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": dimension ", dimension.name,
                                                 " is ", dimension.length, "; 1 to ", kMaxCells,
                                                 " can be read"));
}

absl::StatusOr<WrittenAxis> ReadWritten(const netcdf::NetcdfFile& file,
                                        const CfDimension& dimension, double scale, double period) {
  const std::string& name = dimension.coordinate;
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::string> dimensions, file.Dimensions(name));
  if (dimensions != std::vector<std::string>{dimension.name}) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": the coordinate ", name,
                     " must have its own dimension only; interpolate to a rectangular grid first"));
  }
  WrittenAxis axis;
  THUNDERHEAD_ASSIGN_OR_RETURN(axis.centres, file.ReadDoubles(name));
  Unwrap(axis.centres, period);
  THUNDERHEAD_ASSIGN_OR_RETURN(axis.faces, ReadBounds(file, name, axis.centres.size(), period));
  for (double& centre : axis.centres) centre *= scale;
  for (double& face : axis.faces) face *= scale;
  return axis;
}

// Sets the faces of the axis, in ascending order.
absl::Status TakeFaces(const netcdf::NetcdfFile& file, WrittenAxis written, double single_cell,
                       CfAxis& axis) {
  std::vector<double>& centres = written.centres;
  axis.reversed = centres.front() > centres.back();
  if (axis.reversed) std::ranges::reverse(centres);
  THUNDERHEAD_RETURN_IF_ERROR(CheckMonotonic(file, axis.coordinate, centres));
  if (!written.faces.empty()) {
    axis.faces = std::move(written.faces);
  } else if (centres.size() > 1) {
    axis.faces = FacesAround(centres);
  } else {
    THUNDERHEAD_ASSIGN_OR_RETURN(axis.faces, FacesOfOne(file, centres[0], single_cell, axis));
  }
  if (axis.faces.front() > axis.faces.back()) std::ranges::reverse(axis.faces);
  return CheckMonotonic(file, axis.coordinate, axis.faces);
}

// Returns the first cell whose first bound is not the second bound of the cell before. Returns
// nothing if all cells are adjacent. `pairs` has two bounds for each cell.
std::optional<std::size_t> FirstGap(const std::vector<double>& pairs) {
  // Bounds that are stored as floats differ by rounding.
  constexpr double kRounding = 1e-6;
  for (std::size_t i = 1; 2 * i < pairs.size(); ++i) {
    const double slack = kEvenTolerance * std::abs(pairs[2 * i + 1] - pairs[2 * i]) +
                         kRounding * std::abs(pairs[2 * i]);
    if (!(std::abs(pairs[2 * i] - pairs[2 * i - 1]) <= slack)) return i;
  }
  return std::nullopt;
}

// Returns whether whole numbers follow one another, upwards or downwards.
bool AreNumbersOfLevels(const std::vector<double>& values) {
  if (values.size() < 2 || values[0] != std::floor(values[0])) return false;
  const double step = values[1] - values[0];
  if (std::abs(step) != 1.0) return false;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] != values[i - 1] + step) return false;
  }
  return true;
}

// Returns an error for heights without units that are rather numbers of levels, or heights in km.
absl::Status CheckHeightsWithoutUnits(const netcdf::NetcdfFile& file, const std::string& coordinate,
                                      const std::vector<double>& heights_m,
                                      const std::vector<double>& faces_m) {
  constexpr double kShallow_m = 100.0;
  if (AreNumbersOfLevels(heights_m)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: the coordinate %s has no units, and its values %g, %g, ... %g number the levels; "
        "write heights and their units (m or km) to it, or add an array of heights",
        file.Path(), coordinate, heights_m[0], heights_m[1], heights_m.back()));
  }
  if (faces_m.back() - faces_m.front() >= kShallow_m) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "%s: the coordinate %s has no units, and in m its layers would be only %g m deep in all; add "
      "its units attribute (m or km)",
      file.Path(), coordinate, faces_m.back() - faces_m.front()));
}

// Returns an error for heights that no weather has.
absl::Status CheckAxisOfHeights(const netcdf::NetcdfFile& file, const CfDescription& coordinate,
                                const std::vector<double>& faces_m) {
  if (faces_m.back() > kHighestTop_m) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: the coordinate %s (units '%s') reaches up to %g km, far above the weather; correct "
        "its units attribute",
        file.Path(), coordinate.name, coordinate.units, faces_m.back() / kMetresPerKm));
  }
  if (faces_m.back() > 0.0) return absl::OkStatus();
  const bool down = absl::AsciiStrToLower(coordinate.positive) == "down";
  return absl::InvalidArgumentError(absl::StrFormat(
      "%s: the coordinate %s has %s, so its layers lie %g to %g m below sea level; %s", file.Path(),
      coordinate.name, down ? "positive = 'down'" : "no value above 0", std::abs(faces_m.back()),
      std::abs(faces_m.front()),
      down ? "write 'up' if they are heights" : "write heights above sea level or the ground"));
}

absl::Status WrongLength(const netcdf::NetcdfFile& file, const CfDescription& coordinate,
                         const char* needed) {
  return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": the coordinate ", coordinate.name,
                                                 " has units '", coordinate.units, "'; ", needed));
}

// Returns the axis as one without places, whose cells are only numbered.
CfAxis AxisOfNumbers(CfAxis axis) {
  axis.unit = CfAxisUnit::kNone;
  axis.counted_by = std::move(axis.coordinate);
  axis.coordinate.clear();
  for (int i = 0; i <= axis.cells; ++i) axis.faces.push_back(i);
  return axis;
}

}  // namespace

absl::StatusOr<std::vector<double>> ReadBounds(const netcdf::NetcdfFile& file,
                                               const std::string& coordinate, std::size_t cells,
                                               double period) {
  const auto name = file.TextAttribute(coordinate, "bounds");
  if (!name.has_value() || !file.HasVariable(*name)) return std::vector<double>();
  return ReadBoundsIn(file, *name, coordinate, cells, period);
}

absl::StatusOr<std::vector<double>> ReadBoundsIn(const netcdf::NetcdfFile& file,
                                                 const std::string& bounds,
                                                 const std::string& coordinate, std::size_t cells,
                                                 double period) {
  // Bounds are in the units of their coordinate. CF files usually omit the units of the bounds.
  const std::string units = file.TextOrEmpty(bounds, "units");
  if (!units.empty() && units != file.TextOrEmpty(coordinate, "units")) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": ", bounds, " has units '", units, "', and ", coordinate,
                     ", whose bounds they are, others; give both the same"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::size_t> shape, file.Shape(bounds));
  if (shape != std::vector<std::size_t>{cells, 2}) {
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": ", bounds, ", the bounds of ",
                                                   coordinate, ", must have dimensions (", cells,
                                                   ", 2)"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<double> pairs, file.ReadDoubles(bounds));
  if (period != 0.0) {
    // Both bounds of a cell are moved next to each other, and the cells next to each other.
    for (std::size_t i = 0; i < cells; ++i) {
      std::vector<double> near = {i == 0 ? pairs[0] : 0.5 * (pairs[2 * i - 2] + pairs[2 * i - 1]),
                                  pairs[2 * i], pairs[2 * i + 1]};
      Unwrap(near, period);
      pairs[2 * i] = near[1];
      pairs[2 * i + 1] = near[2];
    }
  }
  // The two bounds of a cell may be in descending order although the axis ascends, or in ascending
  // order although it descends. Neighbouring cells share a face in the right order only.
  std::optional<std::size_t> gap = FirstGap(pairs);
  if (gap.has_value()) {
    std::vector<double> swapped = pairs;
    for (std::size_t i = 0; i < cells; ++i) std::swap(swapped[2 * i], swapped[2 * i + 1]);
    if (!FirstGap(swapped).has_value()) {
      gap.reset();
      pairs = std::move(swapped);
    }
  }
  if (gap.has_value()) {
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": ", bounds, ", the bounds of ",
                                                   coordinate, ", leave a gap before cell ", *gap));
  }
  std::vector<double> faces;
  for (std::size_t i = 0; i < cells; ++i) faces.push_back(pairs[2 * i]);
  faces.push_back(pairs.back());
  return faces;
}

std::vector<double> FacesAround(const std::vector<double>& centres_m) {
  const double even_low_m = 1.5 * centres_m[0] - 0.5 * centres_m[1];
  std::vector<double> faces_m;
  if (IsEven(centres_m)) {
    const auto steps = static_cast<double>(centres_m.size() - 1);
    const double step_m = (centres_m.back() - centres_m.front()) / steps;
    for (const double centre_m : centres_m) faces_m.push_back(centre_m - 0.5 * step_m);
    faces_m.push_back(centres_m.back() + 0.5 * step_m);
    return faces_m;
  }
  const Faces even = FacesFrom(even_low_m, centres_m);
  const Faces grounded = FacesFrom(0.0, centres_m);
  const bool prefer_even = grounded.faces_m.empty() || even.max_change < grounded.max_change;
  if (!even.faces_m.empty() && prefer_even) return even.faces_m;
  if (!grounded.faces_m.empty()) return grounded.faces_m;
  faces_m.push_back(even_low_m);
  for (std::size_t i = 1; i < centres_m.size(); ++i) {
    faces_m.push_back(0.5 * (centres_m[i - 1] + centres_m[i]));
  }
  faces_m.push_back(2.0 * centres_m.back() - faces_m.back());
  return faces_m;
}

absl::StatusOr<CfAxis> ReadHorizontalAxis(const netcdf::NetcdfFile& file,
                                          const CfDimension& dimension, CfDirection direction,
                                          double single_cell) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLength(file, dimension));
  CfAxis axis;
  axis.dimension = dimension.name;
  axis.coordinate = dimension.coordinate;
  axis.cells = static_cast<int>(dimension.length);
  if (dimension.coordinate.empty()) return AxisOfNumbers(std::move(axis));
  const CfDescription described = DescribeCf(file, dimension.coordinate);
  THUNDERHEAD_ASSIGN_OR_RETURN(const bool numbers_cells, NumbersCells(file, described));
  if (numbers_cells) return AxisOfNumbers(std::move(axis));
  if (const auto degrees = DegreesIn(described.units, direction); degrees.has_value()) {
    axis.unit = CfAxisUnit::kDegrees;
    axis.units_per_written = *degrees;
  } else if (const auto metres = MetresIn(described.units); metres.has_value()) {
    axis.units_per_written = *metres;
    if (HasNoUnits(described.units) && IsAngle(described)) {
      return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": the coordinate ",
                                                     described.name,
                                                     " has no units; add them: degrees, m or km"));
    }
    if (HasNoUnits(described.units)) {
      axis.assumptions.push_back(
          absl::StrCat(described.name, " has no units; it is taken to be in m."));
    }
  } else {
    return WrongLength(file, described, "m, km or degrees are needed");
  }
  const bool wraps = axis.unit == CfAxisUnit::kDegrees && direction == CfDirection::kX;
  constexpr double kFullCircle_deg = 360.0;
  const double period = wraps ? kFullCircle_deg / axis.units_per_written : 0.0;
  THUNDERHEAD_ASSIGN_OR_RETURN(WrittenAxis written,
                               ReadWritten(file, dimension, axis.units_per_written, period));
  THUNDERHEAD_RETURN_IF_ERROR(TakeFaces(file, std::move(written), single_cell, axis));
  if (IsEven(axis.faces)) return axis;
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": the coordinate ", axis.coordinate,
                   " is not evenly spaced; interpolate to even spacing first"));
}

absl::StatusOr<CfAxis> ReadHeightAxis(const netcdf::NetcdfFile& file,
                                      const CfDimension& dimension) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLength(file, dimension));
  CfAxis axis;
  axis.dimension = dimension.name;
  axis.coordinate = dimension.coordinate;
  axis.cells = static_cast<int>(dimension.length);
  const CfDescription described = DescribeCf(file, dimension.coordinate);
  const auto metres = MetresIn(described.units);
  if (!metres.has_value()) {
    return WrongLength(file, described,
                       "heights in m or km are needed: interpolate to heights first");
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const double sign, UpwardSign(file, described));
  axis.units_per_written = *metres * sign;
  THUNDERHEAD_ASSIGN_OR_RETURN(WrittenAxis written,
                               ReadWritten(file, dimension, axis.units_per_written, 0.0));
  if (written.centres.size() == 1 && written.faces.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": ", described.name,
                     " has one layer and no bounds, so its thickness is not known; add ",
                     described.name, ":bounds, or give at least two layers"));
  }
  const std::vector<double> heights_m = written.centres;
  THUNDERHEAD_RETURN_IF_ERROR(TakeFaces(file, std::move(written), 0.0, axis));
  THUNDERHEAD_RETURN_IF_ERROR(CheckAxisOfHeights(file, described, axis.faces));
  if (HasNoUnits(described.units)) {
    THUNDERHEAD_RETURN_IF_ERROR(
        CheckHeightsWithoutUnits(file, described.name, heights_m, axis.faces));
  }
  return axis;
}

}  // namespace thunderhead::storm_files
