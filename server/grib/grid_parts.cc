#include "grib/grid_parts.h"

#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace thunderhead::grib {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

absl::Status UnreadGrid(std::string_view what) {
  return absl::InvalidArgumentError(
      absl::StrCat("its grid ", std::string(what),
                   "; put the data on a grid of latitudes and longitudes, for example with "
                   "wgrib2 -new_grid or cdo remap"));
}

absl::Status BadGrid(std::string_view what) {
  return absl::DataLossError(
      absl::StrCat("its grid ", std::string(what), "; the file is damaged: copy it again"));
}

std::string Earth::Text() const {
  return IsSphere() ? absl::StrFormat("+R=%.10g", equator_m)
                    : absl::StrFormat("+a=%.12g +b=%.12g", equator_m, pole_m);
}

absl::StatusOr<Earth> EarthOf(const Octets& section) {
  constexpr double kLeast_m = 1e6;
  constexpr double kMost_m = 1e8;
  const auto shape = section.Unsigned(15, 1);
  const double unit_m = shape == 3 ? 1000.0 : 1.0;
  Earth earth;
  switch (shape) {
    case 0:
      earth = {6'367'470.0, 6'367'470.0};
      break;
    case 1: {
      const double radius_m = section.Scaled(16, 4);
      earth = {radius_m, radius_m};
      break;
    }
    case 2:
      earth = {6'378'160.0, 6'356'775.0};
      break;
    case 3:
    case 7:
      earth = {unit_m * section.Scaled(21, 4), unit_m * section.Scaled(26, 4)};
      break;
    case 4:
      earth = {6'378'137.0, 6'356'752.314};
      break;
    case 5:
      earth = {6'378'137.0, 6'356'752.3142};
      break;
    case 6:
      earth = {6'371'229.0, 6'371'229.0};
      break;
    case 8:
      earth = {6'371'200.0, 6'371'200.0};
      break;
    case 9:
      earth = {6'377'563.396, 6'356'256.909};
      break;
    default:
      return UnreadGrid(absl::StrCat("has the shape of the Earth ", shape, ", which is not known"));
  }
  if (earth.pole_m > kLeast_m && earth.equator_m < kMost_m && earth.pole_m <= earth.equator_m) {
    return earth;
  }
  return BadGrid("has an impossible radius of the Earth");
}

absl::Status ReadScanning(std::uint64_t mode, Grid& grid) {
  constexpr std::uint64_t kWestwards = 0x80;
  constexpr std::uint64_t kNorthwards = 0x40;
  constexpr std::uint64_t kColumnsFirst = 0x20;
  constexpr std::uint64_t kAlternates = 0x10;
  constexpr std::uint64_t kStaggered = 0x0F;
  if ((mode & kStaggered) != 0) return UnreadGrid("has rows that are offset against one another");
  grid.from_east = (mode & kWestwards) != 0;
  grid.from_south = (mode & kNorthwards) != 0;
  grid.columns_first = (mode & kColumnsFirst) != 0;
  grid.alternates = (mode & kAlternates) != 0;
  return absl::OkStatus();
}

absl::Status ReadSize(const Octets& section, Grid& grid) {
  if (section.Unsigned(11, 1) != 0 || section.IsMissing(31, 4) || section.IsMissing(35, 4)) {
    return UnreadGrid("has rows of different lengths (a reduced grid)");
  }
  const std::uint64_t columns = section.Unsigned(31, 4);
  const std::uint64_t rows = section.Unsigned(35, 4);
  const std::uint64_t points = section.Unsigned(7, 4);
  if (columns == 0 || rows == 0 || columns > points || columns * rows != points) {
    return BadGrid(absl::StrCat("has ", columns, " x ", rows, " cells but ", points, " points"));
  }
  constexpr std::uint64_t kMost = 1'000'000;
  if (columns > kMost || rows > kMost) {
    return UnreadGrid(absl::StrCat("has ", columns, " x ", rows, " cells, which are too many"));
  }
  grid.columns = static_cast<int>(columns);
  grid.rows = static_cast<int>(rows);
  return absl::OkStatus();
}

void SetCorner(const glm::dvec2& first, Grid& grid) {
  grid.south_west = first;
  if (grid.from_east) grid.south_west.x -= grid.step.x * (grid.columns - 1);
  if (!grid.from_south) grid.south_west.y -= grid.step.y * (grid.rows - 1);
}

absl::StatusOr<double> AngleUnit_deg(const Octets& section) {
  const std::uint64_t basic = section.Unsigned(39, 4);
  if (basic == 0 || section.IsMissing(39, 4)) return kMicrodegrees;
  const std::uint64_t parts = section.Unsigned(43, 4);
  if (parts == 0 || section.IsMissing(43, 4)) return BadGrid("has a unit of angles without parts");
  return static_cast<double>(basic) / static_cast<double>(parts);
}

double LongitudeRange_deg(const Octets& section, double unit_deg, const Grid& grid) {
  const auto range = static_cast<double>(section.Signed(60, 4) - section.Signed(51, 4));
  double eastwards_deg = std::fmod(unit_deg * (grid.from_east ? -range : range), 360.0);
  if (eastwards_deg < 0.0 || (eastwards_deg == 0.0 && grid.columns > 1)) eastwards_deg += 360.0;
  return eastwards_deg;
}

bool IsWindAlongGrid(const Octets& section, std::size_t octet) {
  constexpr std::uint64_t kAlongGrid = 0x08;  // bit 5
  return (section.Unsigned(octet, 1) & kAlongGrid) != 0;
}

absl::StatusOr<double> StepOf(const Octets& section, std::size_t octet, double unit_deg,
                              double range_deg, int count, const char* name) {
  const double from_range_deg = count > 1 ? range_deg / (count - 1) : kNaN;
  const bool is_given = !section.IsMissing(octet, 4) && section.Unsigned(octet, 4) != 0;
  const double step_deg =
      is_given ? unit_deg * static_cast<double>(section.Unsigned(octet, 4)) : from_range_deg;
  if (count == 1 && !is_given) return 0.0;
  if (!(step_deg > 0.0)) return BadGrid(absl::StrCat("has no distance of its ", name));
  // Coordinates in the file are rounded, so a difference of half a step over the whole range is
  // allowed.
  if (count > 1 && std::abs(step_deg - from_range_deg) * (count - 1) > step_deg / 2.0) {
    return BadGrid(
        absl::StrFormat("has %s %.6g degrees apart, but its first and last point say %.6g", name,
                        step_deg, from_range_deg));
  }
  // The step that follows from the range is preferred, because the step in the file may be rounded.
  return count > 1 ? from_range_deg : step_deg;
}

absl::Status CompleteSteps(Grid& grid) {
  for (const int axis : {0, 1}) {
    if (grid.step[axis] > 0.0) continue;
    const double other_deg = grid.step[1 - axis];
    if (!(other_deg > 0.0)) {
      return UnreadGrid("has one point and no distance of its latitudes and longitudes");
    }
    grid.step[axis] = other_deg;
    grid.assumptions.push_back(absl::StrFormat(
        "The grid has one %s without a width; its cells are taken to be %g degrees wide, as along "
        "the other axis.",
        axis == 0 ? "column" : "row", other_deg));
  }
  return absl::OkStatus();
}

}  // namespace thunderhead::grib
