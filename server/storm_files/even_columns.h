// Columns that are even in true metres. The columns of most models are not: a projected length must
// be divided by the map factor, which varies over the domain, and degrees of longitude shrink with
// latitude. A storm is a grid that is regular in metres, so such columns are resampled. This code
// does not depend on files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "glm/vec2.hpp"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {

// The places of a model's columns on Earth. Columns are counted from west to east and from south to
// north, along the model's own axes.
struct ColumnPlaces {
  glm::ivec2 columns{0};
  // The map projection in which the columns are evenly spaced, in PROJ's notation with the size of
  // the Earth. It is empty if the columns' places are given one by one. Its plane coordinates are
  // in metres. For "+proj=longlat" and "+proj=ob_tran +o_proj=longlat" they are in degrees, and the
  // columns may cross any meridian.
  std::string projection;
  glm::dvec2 first{0.0};  // plane coordinates of the centre of the first (south-western) column
  glm::dvec2 step{0.0};   // between neighbouring columns, above 0
  // Otherwise the place of each column, x fastest, and the radius of the model's Earth. Longitudes
  // may jump by 360 degrees between columns.
  std::vector<float> latitude_deg;
  std::vector<float> longitude_deg;
  double radius_m = 6'371'229.0;

  bool operator==(const ColumnPlaces&) const = default;
};

// The place of an even column among the model's columns.
struct FromColumn {
  std::uint32_t south_west = 0;  // index of the model's column to the south-west
  float east = 0.0F;             // share of that column's neighbour along x, 0 to 1
  float north = 0.0F;            // share of its neighbour along y, 0 to 1
  bool inside = false;           // false if the even column is outside of the model's domain. Then
                                 // the other members describe the nearest place inside.
};

// Columns whose distances are `dx_m` and `dy_m` everywhere, to `largest_error`.
struct EvenColumns {
  glm::ivec2 columns{0};
  double dx_m = 0.0;
  double dy_m = 0.0;
  // The projection in which the columns are even, in PROJ's notation, with true scale at the
  // middle. Its y axis is the columns' y axis.
  std::string projection;
  volume::EarthPlace middle;    // the middle of the model's domain and of the even columns
  double largest_error = 0.0;   // of the distance between neighbouring columns, as a share of it
  glm::ivec2 model_columns{0};  // the number of the model's own columns
  glm::dvec2 shortest_m{0.0};   // the true distances between the model's columns along its own x
  glm::dvec2 longest_m{0.0};    // and y axes: the shortest, the longest
  glm::dvec2 mean_m{0.0};       // and the mean
  double grid_north_rad = 0.0;  // the direction of the model's y axis at the middle,
                                // counter-clockwise from true north

  // The places of the even columns among the model's columns, x fastest. It is empty if the model's
  // columns are even already.
  std::vector<FromColumn> from;
  // The area of each of the model's columns as a share of dx_m * dy_m. Empty if `from` is.
  std::vector<float> model_areas;

  bool Resampled() const { return !from.empty(); }
};

struct EvenOptions {
  // The largest error that is accepted for resampled columns. Distances in one plane are right to
  // 1 % up to about 1270 km from its middle.
  double largest_error = 0.01;
  // If set, the even columns have this number, which is that of another time of a domain that
  // moves.
  std::optional<glm::ivec2> columns;
};

// Returns columns that are even in true metres. If the distances between all neighbouring columns,
// along x and along y, are within 0.5 % of their means, the model's columns stay as they are.
// Otherwise the even columns are a grid with north up in a stereographic projection whose centre is
// the middle of the model's domain. Its columns are as far apart as the model's are on average, or
// farther if there would be more than twice as many. INVALID_ARGUMENT if the places are not usable,
// or if the domain is too large for the accepted error.
absl::StatusOr<EvenColumns> MakeEven(const ColumnPlaces& places, const EvenOptions& options = {});

// Returns the projection that MakeEven gives the columns, with the same errors. It takes less time,
// because it does not resample.
absl::StatusOr<std::string> ProjectionOfEven(const ColumnPlaces& places,
                                             const EvenOptions& options = {});

// Returns a sentence for users that says what was done with the model's columns. It is empty if
// they were not resampled.
std::string AssumptionOf(const EvenColumns& even);

}  // namespace thunderhead::storm_files
