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
#include "grib/gaussian.h"
#include "grib/grid_parts.h"
#include "grib/octets.h"
#include "volume/map_projection.h"

namespace thunderhead::grib {
namespace {

constexpr double kMillimetres = 1e-3;

absl::StatusOr<Grid> ReadLatitudeLongitude(const Octets& section, bool is_rotated) {
  if (section.Count() < (is_rotated ? 84U : 72U)) return BadGrid("has too few numbers");
  Grid grid;
  THUNDERHEAD_RETURN_IF_ERROR(ReadSize(section, grid));
  THUNDERHEAD_RETURN_IF_ERROR(ReadScanning(section.Unsigned(72, 1), grid));
  THUNDERHEAD_ASSIGN_OR_RETURN(const Earth earth, EarthOf(section));
  THUNDERHEAD_ASSIGN_OR_RETURN(const double unit, AngleUnit_deg(section));
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
    return BadGrid("has rows whose direction contradicts its first and last latitude");
  }
  const double eastwards_deg = LongitudeRange_deg(section, unit, grid);
  THUNDERHEAD_ASSIGN_OR_RETURN(
      grid.step.x, StepOf(section, 64, unit, eastwards_deg, grid.columns, "longitudes"));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      grid.step.y, StepOf(section, 68, unit, std::abs(northwards_deg), grid.rows, "latitudes"));
  THUNDERHEAD_RETURN_IF_ERROR(CompleteSteps(grid));
  grid.wind_along_grid = IsWindAlongGrid(section, 55);
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
  grid.wind_along_grid = IsWindAlongGrid(section, 55);
  SetCorner(first_deg, grid);
  grid.projection =
      absl::StrFormat("+proj=ob_tran +o_proj=longlat +o_lat_p=%.10g +o_lon_p=0 +lon_0=%.10g %s",
                      90.0 - middle_deg.y, std::remainder(middle_deg.x, 360.0), earth.Text());
  return grid;
}

// The octets of section 3 with the numbers of a projection, and the section's least length.
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
  grid.wind_along_grid = IsWindAlongGrid(section, 47);
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

// Returns a description, for an error, of a template that is not supported. The numbers are those
// of code table 3.1, and NCEP's own.
std::string NameOfTemplate(std::uint64_t number) {
  switch (number) {
    case 2:
      return "is stretched";
    case 3:
      return "is stretched and rotated";
    case 4:
    case 5:
      return "has latitudes or longitudes at uneven distances";
    case 12:
      return "is on a transverse Mercator map";
    case 13:
    case 23:
    case 33:
      return "has a modelling subdomain on a map";
    case 31:
      return "is on an Albers map";
    case 41:
      return "is Gaussian with a rotated pole";
    case 42:
    case 43:
      return "is Gaussian and stretched";
    case 61:
    case 62:
    case 63:
      return "is spectral on a map";
    case 90:
      return "is a satellite's view";
    case 100:
      return "is unstructured (triangles of an icosahedron)";
    case 110:
      return "is on an azimuthal map of equal distances";
    case 120:
      return "has azimuths and ranges of a radar";
    case 140:
      return "is on a Lambert map of equal areas";
    case 150:
      return "is HEALPix";
    case 204:
      return "is curvilinear";
    case 1000:
      return "is a vertical section";
    case 1100:
    case 1200:
      return "is a section through time";
    case 32768:
      return "is NCEP's rotated Arakawa E grid, whose rows are offset";
    default:
      return "is of a kind that is not known";
  }
}

absl::Status SpectralGrid(std::uint64_t number) {
  return absl::InvalidArgumentError(absl::StrCat(
      "its grid is spectral (spherical harmonics, template 3.", number,
      "), which is not read; compute its values on the hydrometeors' grid, for example with "
      "cdo sp2gpl"));
}

// Reads the grid of ICON's triangles. The file does not contain the positions of its cells.
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
    case 40:
      return ReadGaussian(section);
    case 50:
    case 51:
    case 52:
    case 53:
      return SpectralGrid(number);
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
