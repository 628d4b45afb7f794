#include "storm_files/cell_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/gtc/constants.hpp"
#include "glm/trigonometric.hpp"
#include "glm/vec3.hpp"
#include "storm_files/model_columns.h"
#include "storm_files/point_tree.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {
namespace {

using volume::EarthPlace;
using volume::MapProjection;

// The distance up to which a place belongs to its nearest cell, divided by the distance between
// that cell and its third nearest neighbour. A triangle's corner is as far from the nearest centres
// as neighbouring centres are from one another, which gives 1. The rest is a margin for irregular
// cells.
constexpr double kReach = 1.2;

absl::Status TooWide(const std::string& how_wide) {
  return absl::InvalidArgumentError(
      absl::StrCat("the cells ", how_wide,
                   "; cut a region first, for example with cdo sellonlatbox or with "
                   "MPAS-Limited-Area"));
}

glm::dvec3 UnitVectorOf(const CellPlaces& places, std::size_t cell) {
  const double latitude = glm::radians(places.latitude_deg[cell]);
  const double longitude = glm::radians(places.longitude_deg[cell]);
  return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
          std::sin(latitude)};
}

absl::Status CheckPlaces(const CellPlaces& places) {
  for (std::size_t cell = 0; cell < places.latitude_deg.size(); ++cell) {
    if (IsPlaceOnEarth(places.latitude_deg[cell], places.longitude_deg[cell])) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        "the latitude and longitude of cell ", cell, " are ", places.latitude_deg[cell], " and ",
        places.longitude_deg[cell], " degrees; every cell needs its place"));
  }
  return absl::OkStatus();
}

// Returns the mean place of the cells, or nothing if they surround the Earth.
std::optional<EarthPlace> MeanPlace(const CellPlaces& places) {
  glm::dvec3 mean(0.0);
  for (std::size_t cell = 0; cell < places.latitude_deg.size(); ++cell) {
    mean += UnitVectorOf(places, cell);
  }
  mean /= static_cast<double>(places.latitude_deg.size());
  constexpr double kShortest = 0.3;  // the length is 0.5 for cells that cover a hemisphere
  if (!(glm::length(mean) > kShortest)) return std::nullopt;
  return EarthPlace{glm::degrees(std::atan2(mean.z, std::hypot(mean.x, mean.y))),
                    glm::degrees(std::atan2(mean.y, mean.x))};
}

std::string StereographicOn(const EarthPlace& middle, double radius_m) {
  return absl::StrFormat(
      "+proj=stere +lat_0=%.10g +lon_0=%.10g +k=1 +x_0=0 +y_0=0 +R=%.12g +units=m +no_defs",
      middle.latitude_deg, middle.longitude_deg, radius_m);
}

absl::StatusOr<std::vector<glm::dvec2>> OnMap(const CellPlaces& places, const MapProjection& map) {
  std::vector<glm::dvec2> plane_m;
  plane_m.reserve(places.latitude_deg.size());
  for (std::size_t cell = 0; cell < places.latitude_deg.size(); ++cell) {
    const std::optional<glm::dvec2> at_m =
        map.WorldOf({std::clamp(places.latitude_deg[cell], -90.0, 90.0),
                     std::remainder(places.longitude_deg[cell], 360.0)});
    if (!at_m.has_value()) return TooWide("lie all around the Earth");
    plane_m.push_back(*at_m);
  }
  return plane_m;
}

struct Box {
  glm::dvec2 low{0.0};
  glm::dvec2 high{0.0};

  glm::dvec2 Middle() const { return 0.5 * (low + high); }
  glm::dvec2 Size() const { return high - low; }
};

Box BoxOf(const std::vector<glm::dvec2>& plane_m) {
  Box box{plane_m.front(), plane_m.front()};
  for (const glm::dvec2& at_m : plane_m) {
    box.low = glm::min(box.low, at_m);
    box.high = glm::max(box.high, at_m);
  }
  return box;
}

// Checks that the cells do not lie on one line. The standard deviation of the cells across the line
// that fits them best is compared with the standard deviation along it.
absl::Status CheckArea(const std::vector<glm::dvec2>& plane_m) {
  glm::dvec2 mean_m(0.0);
  for (const glm::dvec2& at_m : plane_m) mean_m += at_m / static_cast<double>(plane_m.size());
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;
  for (const glm::dvec2& at_m : plane_m) {
    const glm::dvec2 off_m = at_m - mean_m;
    xx += off_m.x * off_m.x;
    yy += off_m.y * off_m.y;
    xy += off_m.x * off_m.y;
  }
  // The eigenvalues of the covariance are the squares of the standard deviations.
  const double half = std::hypot(0.5 * (xx - yy), xy);
  const double across = 0.5 * (xx + yy) - half;
  const double along = 0.5 * (xx + yy) + half;
  constexpr double kNarrow = 0.01;
  if (across > kNarrow * kNarrow * along) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "the cells lie on one line, so the domain has no area; give a file with cells side by side");
}

// Distances between the cells and their neighbours.
struct Neighbours {
  double median_m = 0.0;  // median of the distances to the nearest neighbour
  double mean_m = 0.0;
  double shortest_m = 0.0;
  double longest_m = 0.0;
  std::vector<float> reach_m;  // for each cell, the largest distance of a place that belongs to it
};

Neighbours MeasureNeighbours(const PointTree& tree, const std::vector<glm::dvec2>& plane_m) {
  Neighbours neighbours;
  neighbours.reach_m.reserve(plane_m.size());
  std::vector<float> nearest_m;
  nearest_m.reserve(plane_m.size());
  double sum_m = 0.0;
  for (const glm::dvec2& at_m : plane_m) {
    std::array<PointTree::Found, 4> found;  // the cell itself and three others
    tree.FindNearest(at_m, std::numeric_limits<double>::infinity(), found);
    nearest_m.push_back(static_cast<float>(std::sqrt(found[1].square)));
    sum_m += nearest_m.back();
    neighbours.reach_m.push_back(static_cast<float>(kReach * std::sqrt(found[3].square)));
  }
  const auto [shortest, longest] = std::ranges::minmax(nearest_m);
  neighbours.shortest_m = shortest;
  neighbours.longest_m = longest;
  neighbours.mean_m = sum_m / static_cast<double>(plane_m.size());
  const auto middle = nearest_m.begin() + std::ssize(nearest_m) / 2;
  std::nth_element(nearest_m.begin(), middle, nearest_m.end());
  neighbours.median_m = *middle;
  return neighbours;
}

// Finds the nearest cell of each even column.
class CellRaster {
 public:
  // The arguments must outlive the raster.
  CellRaster(const std::vector<glm::dvec2>& plane_m, const Box& box, EvenColumns& even)
      : plane_m_(plane_m),
        tree_(plane_m),
        neighbours_(MeasureNeighbours(tree_, plane_m)),
        box_(box),
        even_(even) {
    const float farthest_m = *std::ranges::max_element(neighbours_.reach_m);
    farthest_square_ = static_cast<double>(farthest_m) * farthest_m * (1.0 + 1e-6);
    even_.model_columns = {static_cast<int>(plane_m.size()), 1};
    even_.unstructured = true;
  }

  const Neighbours& Distances() const { return neighbours_; }

  void Draw() {
    ChooseGrid();
    even_.shortest_m = glm::dvec2(neighbours_.shortest_m);
    even_.longest_m = glm::dvec2(neighbours_.longest_m);
    even_.mean_m = glm::dvec2(neighbours_.mean_m);
    even_.model_areas.assign(static_cast<std::size_t>(even_.model_columns.x), 0.0F);
    even_.from.clear();
    even_.from.reserve(static_cast<std::size_t>(even_.columns.x) *
                       static_cast<std::size_t>(even_.columns.y));
    for (int y = 0; y < even_.columns.y; ++y) {
      for (int x = 0; x < even_.columns.x; ++x) {
        const glm::dvec2 centre(x, y);
        even_.from.push_back(ColumnAt(centre));
        Measure(centre);
      }
    }
  }

 private:
  void ChooseGrid() {
    double spacing_m = neighbours_.median_m;
    const double most = 4.0 * even_.model_columns.x + 16.0;
    // Half a column around the outermost centres belongs to the domain.
    const auto columns = [&] { return glm::ceil(box_.Size() / spacing_m + 0.5); };
    for (glm::dvec2 count = columns(); count.x * count.y > most; count = columns()) {
      constexpr double kLeastStep = 1.001;
      spacing_m *= std::max(std::sqrt(count.x * count.y / most), kLeastStep);
    }
    even_.columns = glm::max(glm::ivec2(columns()), 1);
    even_.dx_m = spacing_m;
    even_.dy_m = spacing_m;
    first_m_ = box_.Middle() - 0.5 * spacing_m * glm::dvec2(even_.columns - 1);
  }

  // Returns the cell nearest to a position in columns, or PointTree::kNone if none is near. `near`
  // is a cell that is probably near, which makes the search faster.
  PointTree::Found CellAt(const glm::dvec2& position, std::uint32_t near) const {
    const glm::dvec2 at_m = first_m_ + position * even_.dx_m;
    const glm::dvec2 way_m = plane_m_[near] - at_m;
    constexpr double kRounding = 1.0 + 1e-9;  // so that `near` itself is found
    const double below = std::min(farthest_square_, kRounding * glm::dot(way_m, way_m) + 1e-9);
    std::array<PointTree::Found, 1> found;
    tree_.FindNearest(at_m, below, found);
    return found[0];
  }

  bool IsInside(const PointTree::Found& found) const {
    if (found.point == PointTree::kNone) return false;
    const double reach_m = neighbours_.reach_m[found.point];
    return found.square <= reach_m * reach_m;
  }

  FromColumn ColumnAt(const glm::dvec2& centre) {
    PointTree::Found found = CellAt(centre, last_);
    FromColumn from;
    from.inside = IsInside(found);
    if (found.point == PointTree::kNone) {
      std::array<PointTree::Found, 1> any;
      tree_.FindNearest(first_m_ + centre * even_.dx_m, std::numeric_limits<double>::infinity(),
                        any);
      found = any[0];
    }
    last_ = found.point;
    // An even column refers to a cell and its eastern neighbour. The last cell has no such
    // neighbour, so it is referred to as the neighbour of the last but one.
    const auto end = static_cast<std::uint32_t>(even_.model_columns.x - 1);
    from.south_west = std::min(found.point, end - 1);
    from.east = found.point == end ? 1.0F : 0.0F;
    return from;
  }

  // Adds the parts of the column to the areas of the cells that are nearest to them. Each part has
  // a place in the column with its own x and y. Places in rows would often be in line with rows of
  // cells, such as those of a reduced Gaussian grid, and areas would then be wrong by 1 %.
  void Measure(const glm::dvec2& centre) {
    constexpr int kParts = 9;
    constexpr float kShare = 1.0F / kParts;
    for (int i = 0; i < kParts; ++i) {
      const glm::dvec2 part = (glm::dvec2(i, 2 * i % kParts) + 0.5) / double{kParts} - 0.5;
      const PointTree::Found found = CellAt(centre + part, last_);
      if (IsInside(found)) even_.model_areas[found.point] += kShare;
    }
  }

  const std::vector<glm::dvec2>& plane_m_;
  const PointTree tree_;
  const Neighbours neighbours_;
  const Box box_;
  EvenColumns& even_;
  glm::dvec2 first_m_{0.0};       // centre of the south-western column
  double farthest_square_ = 0.0;  // squared distance in m2 beyond which a place is outside
  std::uint32_t last_ = 0;        // the cell of the last column
};

absl::Status CheckCount(std::size_t cells) {
  if (cells >= 4 && cells <= kMostCells) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("there are ", cells, " cells, and 4 to ", kMostCells, " can be read"));
}

// Fills in the columns from the cells' positions on the plane.
absl::Status Rasterize(const std::vector<glm::dvec2>& plane_m, const Box& box, EvenColumns& even) {
  CellRaster raster(plane_m, box, even);
  if (!(raster.Distances().median_m > 0.0)) {
    return absl::InvalidArgumentError(
        "most cells are at the same place as another; correct their places");
  }
  raster.Draw();
  return absl::OkStatus();
}

// Returns the distance of the middle from the farthest cell.
double ReachOf_m(const CellPlaces& places, const EarthPlace& middle) {
  double reach_m = 0.0;
  for (std::size_t cell = 0; cell < places.latitude_deg.size(); ++cell) {
    const EarthPlace place{places.latitude_deg[cell], places.longitude_deg[cell]};
    reach_m = std::max(reach_m, GreatCircle_m(middle, place, places.radius_m));
  }
  return reach_m;
}

}  // namespace

absl::StatusOr<EvenColumns> MakeEvenOfCells(const CellPlaces& places) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckCount(places.latitude_deg.size()));
  if (places.latitude_deg.size() != places.longitude_deg.size()) {
    return absl::InvalidArgumentError("there is not one latitude and longitude a cell");
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckPlaces(places));
  const std::optional<EarthPlace> mean = MeanPlace(places);
  if (!mean.has_value()) return TooWide("lie all around the Earth");
  EvenColumns even;
  {
    THUNDERHEAD_ASSIGN_OR_RETURN(const MapProjection map,
                                 MapProjection::Open(StereographicOn(*mean, places.radius_m)));
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<glm::dvec2> plane_m, OnMap(places, map));
    THUNDERHEAD_RETURN_IF_ERROR(CheckArea(plane_m));
    even.middle = map.PlaceOf(BoxOf(plane_m).Middle()).value_or(*mean);
  }
  even.reach_m = ReachOf_m(places, even.middle);
  const double angle = even.reach_m / places.radius_m;
  if (angle > glm::half_pi<double>()) return TooWide("reach farther than a hemisphere");
  // The scale of a stereographic projection at an angle c from its centre is 1 / cos(c / 2)^2.
  const double cosine = std::cos(0.5 * angle);
  even.largest_scale = 1.0 / (cosine * cosine);
  even.largest_error = even.largest_scale - 1.0;
  even.projection = StereographicOn(even.middle, places.radius_m);
  THUNDERHEAD_ASSIGN_OR_RETURN(const MapProjection map, MapProjection::Open(even.projection));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<glm::dvec2> plane_m, OnMap(places, map));
  const Box box = BoxOf(plane_m);
  const glm::dvec2 half_m = glm::max(glm::abs(box.low), glm::abs(box.high));
  THUNDERHEAD_RETURN_IF_ERROR(Rasterize(plane_m, {-half_m, half_m}, even));
  return even;
}

absl::StatusOr<EvenColumns> MakeEvenOfPlane(const std::vector<glm::dvec2>& plane_m) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckCount(plane_m.size()));
  for (const glm::dvec2& at_m : plane_m) {
    constexpr double kFarthest_m = 1e8;
    if (std::abs(at_m.x) <= kFarthest_m && std::abs(at_m.y) <= kFarthest_m) continue;
    return absl::InvalidArgumentError("a cell has no position; every cell needs its place");
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckArea(plane_m));
  EvenColumns even;
  THUNDERHEAD_RETURN_IF_ERROR(Rasterize(plane_m, BoxOf(plane_m), even));
  return even;
}

}  // namespace thunderhead::storm_files
