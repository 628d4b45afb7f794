#include "grib/grid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "glm/trigonometric.hpp"
#include "grib/octets.h"
#include "volume/map_projection.h"

namespace thunderhead::grib {
namespace {

constexpr double kMicrodegrees = 1e-6;
constexpr double kMillimetres = 1e-3;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

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

// The shape of the Earth (code table 3.2).
struct Earth {
  double equator_m = 0.0;  // radius at the equator
  double pole_m = 0.0;     // radius at the poles

  bool IsSphere() const { return equator_m == pole_m; }
  // Returns the parameters for PROJ.
  std::string Text() const {
    return IsSphere() ? absl::StrFormat("+R=%.10g", equator_m)
                      : absl::StrFormat("+a=%.12g +b=%.12g", equator_m, pole_m);
  }
};

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

// Reads the scanning mode (flag table 3.4).
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

// Sets south_west from the first point in the file.
void SetCorner(const glm::dvec2& first, Grid& grid) {
  grid.south_west = first;
  if (grid.from_east) grid.south_west.x -= grid.step.x * (grid.columns - 1);
  if (!grid.from_south) grid.south_west.y -= grid.step.y * (grid.rows - 1);
}

constexpr std::uint64_t kAlongGrid = 0x08;  // flag table 3.3, bit 5

// Returns the step between two coordinates of a grid of latitudes and longitudes in degrees. It is
// given, or follows from the last coordinate. It is 0 if it is not given for the only coordinate.
absl::StatusOr<double> StepOf(const Octets& section, std::size_t octet, double unit,
                              double range_deg, int count, const char* name) {
  const double from_range_deg = count > 1 ? range_deg / (count - 1) : kNaN;
  const bool is_given = !section.IsMissing(octet, 4) && section.Unsigned(octet, 4) != 0;
  const double step_deg =
      is_given ? unit * static_cast<double>(section.Unsigned(octet, 4)) : from_range_deg;
  if (count == 1 && !is_given) return 0.0;
  if (!(step_deg > 0.0)) return BadGrid(absl::StrCat("has no distance of its ", name));
  // Coordinates are rounded to the unit, and longitudes may go around the Earth.
  if (count > 1 && std::abs(step_deg - from_range_deg) * (count - 1) > step_deg / 2.0) {
    return BadGrid(absl::StrFormat("has %s %.6g degrees apart, but its corners say %.6g", name,
                                   step_deg, from_range_deg));
  }
  // The range is exact where the step is a rounded number.
  return count > 1 ? from_range_deg : step_deg;
}

// Gives the only row or column of a grid, if its width is not given, that of the other axis.
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

absl::StatusOr<Grid> ReadLatitudeLongitude(const Octets& section, bool is_rotated) {
  if (section.Count() < (is_rotated ? 84U : 72U)) return BadGrid("has too few numbers");
  Grid grid;
  THUNDERHEAD_RETURN_IF_ERROR(ReadSize(section, grid));
  THUNDERHEAD_RETURN_IF_ERROR(ReadScanning(section.Unsigned(72, 1), grid));
  THUNDERHEAD_ASSIGN_OR_RETURN(const Earth earth, EarthOf(section));
  double unit = kMicrodegrees;
  if (section.Unsigned(39, 4) != 0 && !section.IsMissing(39, 4)) {
    const std::uint64_t parts = section.Unsigned(43, 4);
    if (parts == 0 || section.IsMissing(43, 4))
      return BadGrid("has a unit of angles without parts");
    unit = static_cast<double>(section.Unsigned(39, 4)) / static_cast<double>(parts);
  }
  const auto angle = [&](std::size_t octet) {
    return unit * static_cast<double>(section.Signed(octet, 4));
  };
  const double first_latitude_deg = angle(47);
  const double last_latitude_deg = angle(56);
  const double first_longitude_deg = angle(51);
  constexpr double kPole_deg = 90.0 + 1e-6;
  if (std::abs(first_latitude_deg) > kPole_deg || std::abs(last_latitude_deg) > kPole_deg) {
    return BadGrid("reaches beyond a pole");
  }
  const double northwards_deg = last_latitude_deg - first_latitude_deg;
  if (grid.rows > 1 && (northwards_deg > 0.0) != grid.from_south) {
    return BadGrid("has rows in another direction than its corners");
  }
  double eastwards_deg = angle(60) - first_longitude_deg;
  if (grid.from_east) eastwards_deg = -eastwards_deg;
  eastwards_deg = std::fmod(eastwards_deg, 360.0);
  if (eastwards_deg < 0.0 || (eastwards_deg == 0.0 && grid.columns > 1)) eastwards_deg += 360.0;
  THUNDERHEAD_ASSIGN_OR_RETURN(
      grid.step.x, StepOf(section, 64, unit, eastwards_deg, grid.columns, "longitudes"));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      grid.step.y, StepOf(section, 68, unit, std::abs(northwards_deg), grid.rows, "latitudes"));
  THUNDERHEAD_RETURN_IF_ERROR(CompleteSteps(grid));
  grid.wind_along_grid = (section.Unsigned(55, 1) & kAlongGrid) != 0;
  SetCorner({first_longitude_deg, first_latitude_deg}, grid);
  if (!is_rotated) {
    grid.projection = absl::StrCat("+proj=longlat ", earth.Text(), " +no_defs");
    return grid;
  }
  if (section.Unsigned(81, 4) != 0) return UnreadGrid("is turned about its rotated pole");
  if (!earth.IsSphere()) return UnreadGrid("is rotated on an ellipsoid");
  const double south_pole_deg = angle(73);
  if (std::abs(south_pole_deg) > kPole_deg) return BadGrid("has a south pole beyond the Earth's");
  grid.projection =
      absl::StrFormat("+proj=ob_tran +o_proj=longlat +o_lat_p=%.10g +o_lon_p=0 +lon_0=%.10g %s",
                      -south_pole_deg, std::remainder(angle(77), 360.0), earth.Text());
  return grid;
}

double Degrees(const Octets& section, std::size_t octet) {
  return kMicrodegrees * static_cast<double>(section.Signed(octet, 4));
}

// Returns the longitude and latitude of a place, in degrees, on a grid whose equator and middle
// meridian cross at `origin_deg` (Snyder, "Map projections", equations 5-7 and 5-8b).
glm::dvec2 Rotated_deg(const glm::dvec2& place_deg, const glm::dvec2& origin_deg) {
  const double east = glm::radians(place_deg.x - origin_deg.x);
  const double north = glm::radians(place_deg.y);
  const double origin = glm::radians(origin_deg.y);
  const double across = std::cos(north) * std::sin(east);
  const double along =
      std::cos(origin) * std::cos(north) * std::cos(east) + std::sin(origin) * std::sin(north);
  const double up =
      std::cos(origin) * std::sin(north) - std::sin(origin) * std::cos(north) * std::cos(east);
  return glm::degrees(glm::dvec2(std::atan2(across, along), std::asin(std::clamp(up, -1.0, 1.0))));
}

// Reads NCEP's template 3.32769, which RAP and RRFS use: a rotated grid of latitudes and longitudes
// that is described by its middle (octets 56 to 63). The places of the first and last point
// (octets 47 to 54, 73 to 80) are those on the Earth.
absl::StatusOr<Grid> ReadRotatedByMiddle(const Octets& section) {
  constexpr std::size_t kOctets = 80;
  if (section.Count() < kOctets) return BadGrid("has too few numbers");
  Grid grid;
  THUNDERHEAD_RETURN_IF_ERROR(ReadSize(section, grid));
  THUNDERHEAD_RETURN_IF_ERROR(ReadScanning(section.Unsigned(72, 1), grid));
  THUNDERHEAD_ASSIGN_OR_RETURN(const Earth earth, EarthOf(section));
  if (!earth.IsSphere()) return UnreadGrid("is rotated on an ellipsoid");
  if (section.Unsigned(39, 4) != 0 && !section.IsMissing(39, 4)) {
    return UnreadGrid("has another unit of angles than a microdegree");
  }
  const auto place_deg = [&](std::size_t latitude, std::size_t longitude) {
    return glm::dvec2(Degrees(section, longitude), Degrees(section, latitude));
  };
  const glm::dvec2 middle_deg = place_deg(56, 60);
  if (middle_deg.y < 0.0 || middle_deg.y > 90.0) {
    return UnreadGrid("is rotated around a middle that is not in the northern hemisphere");
  }
  const glm::dvec2 first_deg = Rotated_deg(place_deg(47, 51), middle_deg);
  const glm::dvec2 last_deg = Rotated_deg(place_deg(73, 77), middle_deg);
  const glm::dvec2 range_deg = (last_deg - first_deg) * glm::dvec2(grid.from_east ? -1.0 : 1.0,
                                                                   grid.from_south ? 1.0 : -1.0);
  THUNDERHEAD_ASSIGN_OR_RETURN(
      grid.step.x, StepOf(section, 64, kMicrodegrees, range_deg.x, grid.columns, "longitudes"));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      grid.step.y, StepOf(section, 68, kMicrodegrees, range_deg.y, grid.rows, "latitudes"));
  THUNDERHEAD_RETURN_IF_ERROR(CompleteSteps(grid));
  grid.wind_along_grid = (section.Unsigned(55, 1) & kAlongGrid) != 0;
  SetCorner(first_deg, grid);
  grid.projection =
      absl::StrFormat("+proj=ob_tran +o_proj=longlat +o_lat_p=%.10g +o_lon_p=0 +lon_0=%.10g %s",
                      90.0 - middle_deg.y, std::remainder(middle_deg.x, 360.0), earth.Text());
  return grid;
}

// The places of a projection's numbers in section 3.
struct ProjectedLayout {
  std::size_t least_octets;
  std::size_t scanning;
  std::size_t dx;
  std::size_t dy;
};

absl::StatusOr<Grid> ReadProjected(const Octets& section, const ProjectedLayout& layout,
                                   const std::string& projection) {
  if (section.Count() < layout.least_octets) return BadGrid("has too few numbers");
  Grid grid;
  THUNDERHEAD_RETURN_IF_ERROR(ReadSize(section, grid));
  THUNDERHEAD_RETURN_IF_ERROR(ReadScanning(section.Unsigned(layout.scanning, 1), grid));
  THUNDERHEAD_ASSIGN_OR_RETURN(const Earth earth, EarthOf(section));
  grid.projection = absl::StrCat(projection, " +x_0=0 +y_0=0 ", earth.Text(), " +units=m +no_defs");
  const absl::StatusOr<volume::MapProjection> map = volume::MapProjection::Open(grid.projection);
  if (!map.ok()) {
    return BadGrid(absl::StrCat("has an impossible map projection (", grid.projection, ")"));
  }
  grid.step = {kMillimetres * static_cast<double>(section.Unsigned(layout.dx, 4)),
               kMillimetres * static_cast<double>(section.Unsigned(layout.dy, 4))};
  grid.wind_along_grid = (section.Unsigned(47, 1) & kAlongGrid) != 0;
  const std::optional<glm::dvec2> first =
      map->WorldOf({kMicrodegrees * static_cast<double>(section.Signed(39, 4)),
                    kMicrodegrees * static_cast<double>(section.Signed(43, 4))});
  if (!first.has_value()) return BadGrid("has no place in its map projection");
  SetCorner(*first, grid);
  return grid;
}

absl::StatusOr<Grid> ReadMercator(const Octets& section) {
  constexpr ProjectedLayout kLayout{72, 60, 65, 69};
  if (section.Unsigned(61, 4) != 0) return UnreadGrid("is turned on the Mercator map");
  // The middle meridian is that of the first point, so that the grid crosses no edge of the map.
  const double first_deg = Degrees(section, 43);
  return ReadProjected(section, kLayout,
                       absl::StrFormat("+proj=merc +lat_ts=%.10g +lon_0=%.10g",
                                       Degrees(section, 48), std::remainder(first_deg, 360.0)));
}

absl::StatusOr<Grid> ReadPolarStereographic(const Octets& section) {
  constexpr ProjectedLayout kLayout{65, 65, 56, 60};
  constexpr std::uint64_t kSouthPole = 0x80;
  const bool is_south = (section.Unsigned(64, 1) & kSouthPole) != 0;
  const double true_deg = Degrees(section, 48);
  return ReadProjected(
      section, kLayout,
      absl::StrFormat("+proj=stere +lat_0=%d +lat_ts=%.10g +lon_0=%.10g", is_south ? -90 : 90,
                      is_south ? -std::abs(true_deg) : true_deg,
                      std::remainder(Degrees(section, 52), 360.0)));
}

absl::StatusOr<Grid> ReadLambert(const Octets& section) {
  constexpr ProjectedLayout kLayout{81, 65, 56, 60};
  const double first_deg = Degrees(section, 66);
  const double second_deg = Degrees(section, 70);
  const double true_deg = Degrees(section, 48);
  THUNDERHEAD_ASSIGN_OR_RETURN(
      Grid grid,
      ReadProjected(section, kLayout,
                    absl::StrFormat("+proj=lcc +lat_1=%.10g +lat_2=%.10g +lat_0=%.10g +lon_0=%.10g",
                                    first_deg, second_deg, true_deg,
                                    std::remainder(Degrees(section, 52), 360.0))));
  if (true_deg != first_deg && true_deg != second_deg) {
    grid.assumptions.push_back(
        absl::StrFormat("The grid's spacing is assumed to be that of the map, which is true at "
                        "latitudes %.6g and %.6g, although the file names latitude %.6g.",
                        first_deg, second_deg, true_deg));
  }
  return grid;
}

std::string NameOfTemplate(std::uint64_t number) {
  switch (number) {
    case 4:
    case 5:
      return "has latitudes or longitudes at uneven distances";
    case 12:
      return "is on a transverse Mercator map";
    case 31:
      return "is on an Albers map";
    case 40:
    case 41:
    case 42:
    case 43:
      return "is Gaussian";
    case 50:
    case 51:
    case 52:
    case 53:
      return "is spectral (spherical harmonics)";
    case 90:
      return "is a satellite's view";
    case 100:
      return "is unstructured (triangles of an icosahedron)";
    case 140:
      return "is on a Lambert map of equal areas";
    case 150:
      return "is HEALPix";
    case 32768:
      return "is NCEP's rotated Arakawa E grid, whose rows are offset";
    default:
      return "is of a kind that is not known";
  }
}

// Reads the grid of ICON's triangles, which has no places.
absl::StatusOr<Grid> ReadTriangles(const Octets& section) {
  constexpr std::size_t kOctets = 35;
  constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
  const std::uint64_t points = section.Unsigned(7, 4);
  if (section.Count() < kOctets) return BadGrid("has too few numbers");
  if (points == 0 || points > kMost) return BadGrid(absl::StrCat("has ", points, " cells"));
  std::string uuid;
  for (std::size_t octet = 20; octet <= kOctets; ++octet) {
    const bool begins_part = octet == 24 || octet == 26 || octet == 28 || octet == 30;
    absl::StrAppend(&uuid, begins_part ? "-" : "",
                    absl::Hex(section.Unsigned(octet, 1), absl::kZeroPad2));
  }
  Grid grid;
  grid.columns = static_cast<int>(points);
  grid.rows = 1;
  grid.cells = absl::StrCat("grid ", section.Unsigned(16, 3), " (uuidOfHGrid ", uuid, ")");
  grid.from_south = true;
  return grid;
}

}  // namespace

absl::StatusOr<Grid> ReadGrid(std::span<const std::byte> section3) {
  const Octets section(section3);
  if (section.Count() < 14) return BadGrid("has too few numbers");
  const std::uint64_t number = section.Unsigned(13, 2);
  if (section.Unsigned(6, 1) != 0) return UnreadGrid("is not described in the file");
  switch (number) {
    case 0:
    case 1:
      return ReadLatitudeLongitude(section, number == 1);
    case 10:
      return ReadMercator(section);
    case 20:
      return ReadPolarStereographic(section);
    case 30:
      return ReadLambert(section);
    case 101:
      return ReadTriangles(section);
    case 32769:
      return ReadRotatedByMiddle(section);
    default:
      return UnreadGrid(
          absl::StrCat(NameOfTemplate(number), " (template 3.", number, "), which is not read"));
  }
}

std::vector<float> Arranged(const Grid& grid, std::vector<float> values) {
  if (grid.from_south && !grid.from_east && !grid.columns_first && !grid.alternates) return values;
  std::vector<float> arranged(values.size());
  const auto columns = static_cast<std::size_t>(grid.columns);
  const auto rows = static_cast<std::size_t>(grid.rows);
  const std::size_t along = grid.columns_first ? rows : columns;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t line = i / along;
    std::size_t place = i % along;
    if (grid.alternates && line % 2 == 1) place = along - 1 - place;
    std::size_t x = grid.columns_first ? line : place;
    std::size_t y = grid.columns_first ? place : line;
    if (grid.from_east) x = columns - 1 - x;
    if (!grid.from_south) y = rows - 1 - y;
    arranged[y * columns + x] = values[i];
  }
  return arranged;
}

}  // namespace thunderhead::grib
