#include "storm_files/cf_axes.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "spdlog/spdlog.h"

namespace thunderhead::storm_files {
namespace {

constexpr std::size_t kMaxCells = 100'000;

// A relative tolerance. It is necessary because coordinates are often rounded when they are
// written, or stored as floats.
constexpr double kEvenTolerance = 1e-2;

struct Coordinate {
  std::vector<double> centres_m;  // in the file's order
  std::vector<double> faces_m;    // one face more than centres, from the bounds; empty if the file
                                  // has no bounds
  std::optional<double> middle_deg;
};

// Returns the faces from CF bounds, two for each cell, or an empty list if there are no bounds.
// Bounds that are not contiguous are an error.
absl::StatusOr<std::vector<double>> ReadBounds(const netcdf::NetcdfFile& file,
                                               const std::string& dimension, std::size_t cells) {
  const auto name = file.TextAttribute(dimension, "bounds");
  std::vector<double> faces;
  if (!name.has_value() || !file.HasVariable(*name)) return faces;
  // Bounds are in the units of their coordinate. CF files usually omit the units of the bounds.
  const std::string units = file.TextOrEmpty(*name, "units");
  if (!units.empty() && units != file.TextOrEmpty(dimension, "units")) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": ", *name, " has units '", units, "', and ", dimension,
                     ", whose bounds they are, others; give both the same"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::size_t> shape, file.Shape(*name));
  if (shape != std::vector<std::size_t>{cells, 2}) {
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": ", *name, ", the bounds of ",
                                                   dimension, ", must have dimensions (", cells,
                                                   ", 2)"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<double> pairs, file.ReadDoubles(*name));
  // The two bounds of a cell may be in descending order although the axis ascends, or in ascending
  // order although it descends.
  if (cells > 1 && (pairs[0] < pairs[1]) != (pairs[0] < pairs[2])) {
    for (std::size_t i = 0; i < cells; ++i) std::swap(pairs[2 * i], pairs[2 * i + 1]);
  }
  for (std::size_t i = 0; i < cells; ++i) {
    const double slack = kEvenTolerance * std::abs(pairs[2 * i + 1] - pairs[2 * i]);
    if (i > 0 && !(std::abs(pairs[2 * i] - pairs[2 * i - 1]) <= slack)) {
      return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": ", *name, ", the bounds of ",
                                                     dimension, ", leave a gap before cell ", i));
    }
    faces.push_back(pairs[2 * i]);
  }
  faces.push_back(pairs.back());
  return faces;
}

// Returns whether the name of a coordinate is that of a longitude or latitude. The name is used
// because the units may be missing.
bool IsAngle(const CfDescription& coordinate) {
  const std::string name = absl::AsciiStrToLower(
      coordinate.standard_name.empty() ? coordinate.name : coordinate.standard_name);
  return name == "lon" || name == "lat" || name.ends_with("longitude") ||
         name.ends_with("latitude");
}

absl::StatusOr<double> MetresPerUnit(const netcdf::NetcdfFile& file,
                                     const CfDescription& coordinate, CfDirection direction,
                                     double metres_per_degree) {
  if (IsDegrees(coordinate.units, direction)) return metres_per_degree;
  const auto metres = MetresIn(coordinate.units);
  const bool assumed = PlainUnits(coordinate.units).empty();
  if (assumed && IsAngle(coordinate)) {
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": the coordinate ",
                                                   coordinate.name,
                                                   " has no units; add them: degrees, m or km"));
  }
  if (assumed) spdlog::warn("{}: {} has no units; taken to be in m", file.Path(), coordinate.name);
  if (metres.has_value()) return *metres;
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": the coordinate ", coordinate.name, " has units '", coordinate.units,
      direction == CfDirection::kZ
          ? "'; heights in m or km are needed: interpolate to heights first"
          : "'; m, km or degrees are needed"));
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

absl::StatusOr<Coordinate> ReadCoordinate(const netcdf::NetcdfFile& file,
                                          const std::string& dimension, CfDirection direction,
                                          double metres_per_degree) {
  if (!file.HasVariable(dimension)) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": the dimension ", dimension, " has no coordinate variable ",
                     dimension, ", so its cells have no size; add one, in metres"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::string> dimensions,
                               file.Dimensions(dimension));
  if (dimensions != std::vector<std::string>{dimension}) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": the coordinate ", dimension,
                     " must have its own dimension only; interpolate to a rectangular grid first"));
  }
  const CfDescription description = DescribeCf(file, dimension);
  THUNDERHEAD_ASSIGN_OR_RETURN(double scale,
                               MetresPerUnit(file, description, direction, metres_per_degree));
  Coordinate coordinate;
  THUNDERHEAD_ASSIGN_OR_RETURN(coordinate.centres_m, file.ReadDoubles(dimension));
  THUNDERHEAD_ASSIGN_OR_RETURN(coordinate.faces_m,
                               ReadBounds(file, dimension, coordinate.centres_m.size()));
  if (IsDegrees(description.units, direction)) {
    coordinate.middle_deg = 0.5 * (coordinate.centres_m.front() + coordinate.centres_m.back());
  }
  if (direction == CfDirection::kZ) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const double sign, UpwardSign(file, description));
    scale *= sign;
  }
  for (double& centre : coordinate.centres_m) centre *= scale;
  for (double& face : coordinate.faces_m) face *= scale;
  return coordinate;
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

// Returns the faces of the cells around two or more `centres_m`. If possible, the cells start at
// the ground and `centres_m` are exactly their centres. Otherwise each face is half-way between two
// neighbouring centres.
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

// Returns the faces of an axis's only cell, if it has no bounds. The cell is assumed to begin at 0,
// like a layer on the ground.
absl::StatusOr<std::vector<double>> FacesOfOne(const netcdf::NetcdfFile& file,
                                               const std::string& dimension, CfDirection direction,
                                               double centre_m, double size_without_bounds_m) {
  double size_m = 2.0 * std::abs(centre_m);
  double low_m = std::min(0.0, 2.0 * centre_m);
  if (size_m == 0.0 && direction != CfDirection::kZ) {
    size_m = size_without_bounds_m;
    low_m = -0.5 * size_m;
  }
  if (!(size_m > 0.0)) {
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": ", dimension, " has one cell at 0 and no bounds, so it has no size; add ",
        dimension, ":bounds"));
  }
  spdlog::warn("{}: {} has one cell and no bounds; taken to be {} m wide", file.Path(), dimension,
               size_m);
  return std::vector<double>{low_m, low_m + size_m};
}

}  // namespace

CfDescription DescribeCf(const netcdf::NetcdfFile& file, const std::string& variable) {
  const auto text = [&](const char* attribute) { return file.TextOrEmpty(variable, attribute); };
  return {variable, text("standard_name"), text("units"), text("axis"), text("positive")};
}

absl::StatusOr<CfAxis> ReadCfAxis(const netcdf::NetcdfFile& file, const std::string& dimension,
                                  CfDirection direction, const CfSizes& sizes) {
  const std::size_t length = file.DimensionLength(dimension).value_or(0);
  if (length < 1 || length > kMaxCells) {
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": dimension ", dimension, " is ",
                                                   length, "; 1 to ", kMaxCells, " can be read"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(Coordinate coordinate,
                               ReadCoordinate(file, dimension, direction, sizes.metres_per_degree));
  CfAxis axis;
  axis.dimension = dimension;
  axis.cells = static_cast<int>(length);
  axis.middle_deg = coordinate.middle_deg;
  std::vector<double>& centres_m = coordinate.centres_m;
  std::vector<double>& faces_m = coordinate.faces_m;
  axis.reversed = centres_m.front() > centres_m.back();
  if (axis.reversed) std::ranges::reverse(centres_m);
  THUNDERHEAD_RETURN_IF_ERROR(CheckMonotonic(file, dimension, centres_m));
  if (faces_m.empty()) {
    if (centres_m.size() > 1) {
      faces_m = FacesAround(centres_m);
    } else {
      THUNDERHEAD_ASSIGN_OR_RETURN(
          faces_m, FacesOfOne(file, dimension, direction, centres_m[0], sizes.single_cell_m));
    }
  }
  if (faces_m.front() > faces_m.back()) std::ranges::reverse(faces_m);
  THUNDERHEAD_RETURN_IF_ERROR(CheckMonotonic(file, dimension, faces_m));
  axis.spacing_m = (faces_m.back() - faces_m.front()) / axis.cells;
  if (direction != CfDirection::kZ && !IsEven(faces_m)) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": the coordinate ", dimension,
                     " is not evenly spaced; interpolate to even spacing first"));
  }
  axis.faces_m = std::move(faces_m);
  return axis;
}

}  // namespace thunderhead::storm_files
