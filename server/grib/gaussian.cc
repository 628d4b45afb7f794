#include "grib/gaussian.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "glm/trigonometric.hpp"
#include "grib/grid_parts.h"

namespace thunderhead::grib {
namespace {

constexpr std::size_t kListOctet = 73;  // the first octet of the numbers of points in rows

// Returns the colatitude, as a share of 180 degrees, of the zero with the index `i` of the Legendre
// polynomial of degree `degree`. It is accurate to a hundredth of the distance between zeros
// (Abramowitz and Stegun, "Handbook of mathematical functions", 22.16.6).
double NearZero(double i, int degree) { return (i + 0.75) / (degree + 0.5); }

// Returns the sine of the latitude of the zero with the index `i`, by Newton's method.
double ZeroOfLegendre(int i, int degree) {
  double x = std::cos(std::numbers::pi * NearZero(i, degree));
  constexpr int kSteps = 8;
  for (int step = 0; step < kSteps; ++step) {
    // The recurrence of Legendre polynomials (8.5.3), and their derivative (8.5.4).
    double before = 1.0;
    double value = x;
    for (int n = 2; n <= degree; ++n) {
      const double next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
      before = value;
      value = next;
    }
    const double slope = degree * (x * value - before) / (x * x - 1.0);
    const double correction = value / slope;
    x -= correction;
    if (std::abs(correction) < 1e-14) break;
  }
  return x;
}

// Returns the index of the Gaussian latitude that equals `latitude_deg` to a twentieth of the
// distance between latitudes.
std::optional<int> IndexOfLatitude(int parallels, double latitude_deg) {
  constexpr double kShare = 0.05;
  const int degree = 2 * parallels;
  const double index = std::round((90.0 - latitude_deg) / 180.0 * (degree + 0.5) - 0.75);
  if (!(index >= 0.0 && index < degree)) return std::nullopt;
  const int i = static_cast<int>(index);
  const double error_deg = std::abs(GaussianLatitudes_deg(parallels, i, 1)[0] - latitude_deg);
  return error_deg < kShare * 180.0 / degree ? std::optional(i) : std::nullopt;
}

// Returns the latitudes of the grid's rows in the file's order, which are `rows` of the Gaussian
// latitudes from the one in octet 47 to the one in octet 56.
absl::StatusOr<std::vector<double>> RowLatitudes_deg(const Octets& section, double unit_deg,
                                                     int rows, bool from_south) {
  const std::uint64_t parallels = section.Unsigned(68, 4);
  if (parallels == 0 || section.IsMissing(68, 4)) {
    return BadGrid("is Gaussian without a number of parallels");
  }
  if (parallels > kMostParallels) {
    return UnreadGrid(absl::StrCat("is Gaussian with ", parallels,
                                   " parallels between a pole and the equator, more than ",
                                   kMostParallels));
  }
  const auto count = static_cast<int>(parallels);
  const auto index = [&](std::size_t octet) -> absl::StatusOr<int> {
    const double latitude_deg = unit_deg * static_cast<double>(section.Signed(octet, 4));
    const std::optional<int> found = IndexOfLatitude(count, latitude_deg);
    if (found.has_value()) return *found;
    return BadGrid(absl::StrFormat(
        "has the latitude %.6g at its edge, which no Gaussian grid of %d parallels has",
        latitude_deg, count));
  };
  THUNDERHEAD_ASSIGN_OR_RETURN(const int first, index(47));
  THUNDERHEAD_ASSIGN_OR_RETURN(const int last, index(56));
  if (std::abs(last - first) != rows - 1) {
    return BadGrid(absl::StrCat("has ", rows, " rows, but its first and last latitude say ",
                                std::abs(last - first) + 1));
  }
  if (rows > 1 && (last < first) != from_south) {
    return BadGrid("has rows whose direction contradicts its first and last latitude");
  }
  std::vector<double> latitudes = GaussianLatitudes_deg(count, std::min(first, last), rows);
  if (from_south) std::ranges::reverse(latitudes);
  return latitudes;
}

// Places rows of equally many points. The rows are placed at even distances. No Gaussian latitude
// is farther from the place of its row than 2 % of the distance between rows.
void PlaceRegularRows(const std::vector<double>& latitudes_deg, double unit_deg,
                      const Octets& section, Grid& grid) {
  const double range_deg = std::abs(latitudes_deg.back() - latitudes_deg.front());
  grid.step.y = grid.rows > 1 ? range_deg / (grid.rows - 1)
                              : 180.0 / (2.0 * static_cast<double>(section.Unsigned(68, 4)) + 0.5);
  SetCorner({unit_deg * static_cast<double>(section.Signed(51, 4)), latitudes_deg.front()}, grid);
  double largest = 0.0;
  for (int row = 0; row < grid.rows; ++row) {
    const double latitude_deg =
        latitudes_deg[static_cast<std::size_t>(grid.from_south ? row : grid.rows - 1 - row)];
    const double even_deg = grid.south_west.y + row * grid.step.y;
    largest = std::max(largest, std::abs(latitude_deg - even_deg) / grid.step.y);
  }
  constexpr double kUnsaid = 1e-3;
  if (largest < kUnsaid) return;
  grid.assumptions.push_back(absl::StrFormat(
      "The grid's Gaussian latitudes are treated as evenly spaced, which moves rows "
      "by at most %.1f %% of their distance.",
      100.0 * largest));
}

absl::StatusOr<Grid> ReadRegular(const Octets& section, const Earth& earth) {
  Grid grid;
  THUNDERHEAD_RETURN_IF_ERROR(ReadSize(section, grid));
  THUNDERHEAD_RETURN_IF_ERROR(ReadScanning(section.Unsigned(72, 1), grid));
  THUNDERHEAD_ASSIGN_OR_RETURN(const double unit_deg, AngleUnit_deg(section));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> latitudes_deg,
                               RowLatitudes_deg(section, unit_deg, grid.rows, grid.from_south));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      grid.step.x, StepOf(section, 64, unit_deg, LongitudeRange_deg(section, unit_deg, grid),
                          grid.columns, "longitudes"));
  grid.wind_along_grid = IsWindAlongGrid(section, 55);
  PlaceRegularRows(latitudes_deg, unit_deg, section, grid);
  THUNDERHEAD_RETURN_IF_ERROR(CompleteSteps(grid));
  grid.projection = absl::StrCat("+proj=longlat ", earth.Text(), " +no_defs");
  return grid;
}

// Returns the cells of a row between two longitudes. A whole circle has `around` cells, from the
// meridian 0 on. Cells may lie outside of the longitudes by `slack_deg`.
CellRow CellsOf(std::uint64_t around, double west_deg, double east_deg, double slack_deg) {
  CellRow row;
  row.step_deg = 360.0 / static_cast<double>(around);
  const double first = std::ceil((west_deg - slack_deg) / row.step_deg);
  const double last = std::floor((east_deg + slack_deg) / row.step_deg);
  row.first_longitude_deg = first * row.step_deg;
  row.cells = static_cast<int>(std::clamp(last - first + 1.0, 0.0, static_cast<double>(around)));
  return row;
}

// Finds the cells of each row, of which there must be `points` in all. Longitudes at the edges are
// rounded in the file, to microdegrees or to millidegrees.
absl::StatusOr<std::vector<CellRow>> RowsOfCells(const std::vector<std::uint64_t>& around,
                                                 const std::vector<double>& latitudes_deg,
                                                 double west_deg, double east_deg,
                                                 std::uint64_t points) {
  for (const double slack_deg : {2e-6, 1e-3}) {
    std::vector<CellRow> rows;
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < around.size(); ++i) {
      CellRow row = CellsOf(around[i], west_deg, east_deg, slack_deg);
      row.latitude_deg = latitudes_deg[i];
      sum += static_cast<std::uint64_t>(row.cells);
      rows.push_back(row);
    }
    if (sum == points) return rows;
  }
  return BadGrid(absl::StrCat(
      "has ", points,
      " points, which is not the number in its rows between its first and last longitude"));
}

absl::StatusOr<Grid> ReadReduced(const Octets& section, const Earth& earth) {
  constexpr std::uint64_t kFullCircles = 1;  // code table 3.11
  constexpr std::uint64_t kMostAround = 1'000'000;
  constexpr std::uint64_t kMostPoints = std::numeric_limits<std::int32_t>::max();
  const std::uint64_t octets = section.Unsigned(11, 1);
  const std::uint64_t rows = section.Unsigned(35, 4);
  const std::uint64_t points = section.Unsigned(7, 4);
  if (section.Unsigned(12, 1) != kFullCircles || octets == 0) {
    return UnreadGrid("is a reduced Gaussian grid whose rows are not described as full circles");
  }
  if (earth.equator_m != 6'371'229.0 || !earth.IsSphere()) {
    return UnreadGrid("is a reduced Gaussian grid on an Earth other than a sphere of 6371229 m");
  }
  if (rows == 0 || rows > 2 * kMostParallels || points == 0 || points > kMostPoints || octets > 4 ||
      section.Count() < kListOctet - 1 + rows * octets) {
    return BadGrid("has an incomplete list of the points in its rows");
  }
  Grid scanning;
  THUNDERHEAD_RETURN_IF_ERROR(ReadScanning(section.Unsigned(72, 1), scanning));
  if (scanning.from_east || scanning.columns_first || scanning.alternates) {
    return UnreadGrid("is a reduced Gaussian grid whose rows do not all run eastwards");
  }
  std::vector<std::uint64_t> around;
  for (std::size_t i = 0; i < rows; ++i) {
    around.push_back(section.Unsigned(kListOctet + i * octets, octets));
    if (around.back() == 0 || around.back() > kMostAround) {
      return BadGrid(absl::StrCat("has ", around.back(), " points in a row"));
    }
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const double unit_deg, AngleUnit_deg(section));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const std::vector<double> latitudes_deg,
      RowLatitudes_deg(section, unit_deg, static_cast<int>(rows), scanning.from_south));
  const double west_deg = unit_deg * static_cast<double>(section.Signed(51, 4));
  Grid grid;
  grid.columns = static_cast<int>(points);
  grid.rows = 1;
  THUNDERHEAD_ASSIGN_OR_RETURN(
      grid.cell_rows, RowsOfCells(around, latitudes_deg, west_deg,
                                  west_deg + LongitudeRange_deg(section, unit_deg, grid), points));
  grid.cells = absl::StrCat("reduced Gaussian grid N", section.Unsigned(68, 4));
  grid.from_south = true;
  return grid;
}

}  // namespace

std::vector<double> GaussianLatitudes_deg(int parallels, int first, int count) {
  std::vector<double> latitudes_deg;
  for (int i = first; i < first + count; ++i) {
    latitudes_deg.push_back(glm::degrees(std::asin(ZeroOfLegendre(i, 2 * parallels))));
  }
  return latitudes_deg;
}

absl::StatusOr<Grid> ReadGaussian(const Octets& section) {
  if (section.Count() < kListOctet - 1) return BadGrid("has too few numbers");
  THUNDERHEAD_ASSIGN_OR_RETURN(const Earth earth, EarthOf(section));
  return section.IsMissing(31, 4) ? ReadReduced(section, earth) : ReadRegular(section, earth);
}

}  // namespace thunderhead::grib
