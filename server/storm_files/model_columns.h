// The places of a model's columns at any position between them.
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "glm/vec2.hpp"
#include "storm_files/even_columns.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {

// Returns whether these are a latitude and a longitude. Rounded latitudes may exceed 90 degrees by
// 0.001. Longitudes may reach 720 degrees, so codes for missing values, such as -999, are none.
// Returns false for NaN.
bool IsPlaceOnEarth(double latitude_deg, double longitude_deg);

// Returns the distance between two places on a sphere, along a great circle.
double GreatCircle_m(const volume::EarthPlace& a, const volume::EarthPlace& b, double radius_m);

// Returns the mean radius of the Earth.
double MeanRadius_m(const volume::EarthFigure& earth);

// Returns the distance between two places on an ellipsoid or a sphere. On an ellipsoid it is
// accurate to 0.01 % up to some hundred kilometres.
double ShortDistance_m(const volume::EarthPlace& a, const volume::EarthPlace& b,
                       const volume::EarthFigure& earth);

// Positions are in columns: (0, 0) is the centre of the south-western column, and x and y grow by 1
// from column to column.
class ModelColumns {
 public:
  // Checks the places. Returns INVALID_ARGUMENT if they are not usable.
  static absl::StatusOr<ModelColumns> Of(const ColumnPlaces& places);

  const glm::ivec2& Count() const { return places_.columns; }
  bool IsProjected() const { return map_.has_value(); }

  // Returns the place at a position. Positions may lie half a column outside of the outermost
  // columns. Returns nothing if they lie beyond the map.
  std::optional<volume::EarthPlace> PlaceAt(const glm::dvec2& position) const;

  // Returns the place of the middle of the domain.
  std::optional<volume::EarthPlace> Middle() const { return PlaceAt(MiddlePosition()); }
  glm::dvec2 MiddlePosition() const { return 0.5 * glm::dvec2(Count() - 1); }

  // Returns the projection with metres in its plane. It is empty if places are given one by one.
  const std::string& Projection() const { return places_.projection; }
  // Returns the plane coordinates of a position in Projection().
  glm::dvec2 PlaneAt(const glm::dvec2& position) const;
  // Returns the size of the Earth in PROJ's notation.
  const std::string& Earth() const { return earth_; }

 private:
  ModelColumns() = default;
  absl::Status CheckProjected();
  absl::Status CheckListed() const;
  std::optional<volume::EarthPlace> BetweenColumns(const glm::dvec2& position) const;

  ColumnPlaces places_;
  std::string earth_;
  std::optional<volume::MapProjection> map_;
  // The plane coordinate y of the pole, for columns whose steps were given in degrees. The edge of
  // a column at a pole does not reach beyond it.
  std::optional<double> pole_m_;
};

}  // namespace thunderhead::storm_files
