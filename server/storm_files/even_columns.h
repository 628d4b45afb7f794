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
  // If `projection` is empty: the place of each column, x fastest, and the radius of the model's
  // Earth. Longitudes may jump by 360 degrees between columns.
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

// Columns whose distances are `dx_m` and `dy_m` on a flat map. Everywhere they are within 1 % of
// true distances, or within `largest_error` if the domain is too wide for that.
struct EvenColumns {
  glm::ivec2 columns{0};
  double dx_m = 0.0;
  double dy_m = 0.0;
  // The projection in which the columns are even, in PROJ's notation, with true scale at the
  // middle. Its y axis is the columns' y axis.
  std::string projection;
  volume::EarthPlace middle;  // the middle of the model's domain and of the even columns
  double reach_m = 0.0;       // distance from the middle to the farthest edge; 0 if not measured
  // Lengths on the map divided by true lengths: the smallest and the largest ratio in the domain.
  double least_scale = 1.0;
  double largest_scale = 1.0;
  double largest_error = 0.0;   // the larger deviation of these two ratios from 1
  glm::ivec2 model_columns{0};  // the number of the model's own columns
  // The true distances between neighbouring columns of the model, along its own x and y axes.
  glm::dvec2 shortest_m{0.0};
  glm::dvec2 longest_m{0.0};
  glm::dvec2 mean_m{0.0};
  double grid_north_rad = 0.0;  // the direction of the model's y axis at the middle,
                                // counter-clockwise from true north

  // True if the model's columns are the cells of an unstructured grid, in one row. Then each even
  // column has the values of the nearest cell, and `mean_m` is the mean distance between a cell and
  // its nearest neighbour.
  bool unstructured = false;
  // The places of the even columns among the model's columns, x fastest. It is empty if the model's
  // columns are even already.
  std::vector<FromColumn> from;
  // The area of each of the model's columns as a share of dx_m * dy_m. Empty if `from` is.
  std::vector<float> model_areas;

  bool Resampled() const { return !from.empty(); }
  // Returns whether no flat map has true distances in the whole domain.
  bool IsTooWide() const { return largest_error > 0.01; }
  // Returns the distances between the model's own columns, or their means if they are resampled.
  glm::dvec2 ModelSpacing_m() const { return Resampled() ? mean_m : glm::dvec2(dx_m, dy_m); }
};

struct EvenOptions {
  // If set, the number of even columns along x and y. A domain that moves must have the same number
  // at all its times.
  std::optional<glm::ivec2> columns;
};

// Returns columns that are even in true metres.
// - If the distances between all neighbouring columns, along x and along y, are within 0.5 % of
//   their means, the model's columns stay as they are.
// - Otherwise the even columns are a grid with north up in a stereographic projection whose centre
//   is the middle of the model's domain. Its columns are as far apart as the model's are on
//   average, or farther if there would be more than twice as many.
// - Distances on one flat map are right to 1 % up to about 1270 km from its middle. The columns of
//   a wider domain stay on the model's map if that is conformal and its distances are right to
//   20 %. Otherwise they are resampled to the conformal map with the smallest errors. If the domain
// is wider than a hemisphere, the model's map is the only one. Returns INVALID_ARGUMENT if the
// places are not usable, or if a domain wider than a hemisphere has no map. Returns
// RESOURCE_EXHAUSTED if there are too many columns to resample.
absl::StatusOr<EvenColumns> MakeEven(const ColumnPlaces& places, const EvenOptions& options = {});

// Returns the projection that MakeEven gives the columns, with the same errors. It takes less time,
// because it does not resample.
absl::StatusOr<std::string> ProjectionOfEven(const ColumnPlaces& places,
                                             const EvenOptions& options = {});

// Returns sentences for users that say what was done with the model's columns, and how far
// distances are from true ones. It is empty if the columns are as the model has them, with true
// distances.
std::vector<std::string> AssumptionsOf(const EvenColumns& even);

}  // namespace thunderhead::storm_files
