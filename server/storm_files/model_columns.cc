#include "storm_files/model_columns.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "glm/vec3.hpp"
#include "storm_files/true_scale.h"

namespace thunderhead::storm_files {
namespace {

// Turns a grid of longitudes and latitudes, possibly with a rotated pole, into one in metres of the
// projection eqc, in which a degree is equally long everywhere.
void ToMetres(ColumnPlaces& places) {
  ProjectionWords words(places.projection);
  const double radius_m = words.Number("R").value_or(words.Number("a").value_or(places.radius_m));
  // PROJ's eqc is a projection of a sphere, so the radius replaces an ellipsoid.
  for (const char* const name : {"a", "b", "rf", "f", "ellps", "datum"}) words.Remove(name);
  words.Set("R", radius_m);
  if (words.Text("proj") == "ob_tran") {
    words.Set("o_proj", "eqc");
  } else {
    // The central meridian is that of the domain, so the domain may cross any meridian.
    const double middle_deg = places.first.x + 0.5 * places.step.x * (places.columns.x - 1);
    words.Set("proj", "eqc");
    words.Set("lon_0", std::remainder(middle_deg, 360.0));
    places.first.x -= middle_deg;
  }
  places.projection = words.Joined();
  places.first = radius_m * glm::radians(places.first);
  places.step = radius_m * glm::radians(places.step);
}

constexpr double kPole_deg = 90.001;

// Returns an error if the columns of a grid in degrees lie beyond a pole, or so many turns around
// the Earth that their longitudes lose metres.
absl::Status CheckDegrees(const ColumnPlaces& places) {
  constexpr double kMostTurns_deg = 1e6;
  const glm::dvec2& first = places.first;
  const glm::dvec2 last = first + glm::dvec2(places.columns - 1) * places.step;
  const glm::dvec2 farthest = glm::max(glm::abs(first), glm::abs(last));
  if (farthest.x <= kMostTurns_deg && farthest.y <= kPole_deg) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "the columns lie from %.7g to %.7g degrees north and from %.7g to %.7g degrees east, and "
      "there are no such places; correct the latitudes and longitudes",
      first.y, last.y, first.x, last.x));
}

glm::dvec3 Direction(double latitude_deg, double longitude_deg) {
  const double latitude = glm::radians(latitude_deg);
  const double longitude = glm::radians(longitude_deg);
  return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
          std::sin(latitude)};
}

}  // namespace

bool IsPlaceOnEarth(double latitude_deg, double longitude_deg) {
  constexpr double kMostTurns_deg = 720.0;
  return std::abs(latitude_deg) <= kPole_deg && std::abs(longitude_deg) <= kMostTurns_deg;
}

// The haversine formula is accurate for short distances too.
double GreatCircle_m(const volume::EarthPlace& a, const volume::EarthPlace& b, double radius_m) {
  const double from = glm::radians(a.latitude_deg);
  const double to = glm::radians(b.latitude_deg);
  const double north = std::sin(0.5 * (to - from));
  const double east = std::sin(0.5 * glm::radians(b.longitude_deg - a.longitude_deg));
  const double square = north * north + std::cos(from) * std::cos(to) * east * east;
  return 2.0 * radius_m * std::asin(std::sqrt(std::min(square, 1.0)));
}

double MeanRadius_m(const volume::EarthFigure& earth) {
  const double flattening = earth.inverse_flattening > 0.0 ? 1.0 / earth.inverse_flattening : 0.0;
  return earth.semi_major_m * (1.0 - flattening / 3.0);
}

// Turns the straight line through the Earth into an arc of the mean curvature.
double ShortDistance_m(const volume::EarthPlace& a, const volume::EarthPlace& b,
                       const volume::EarthFigure& earth) {
  if (earth.inverse_flattening == 0.0) return GreatCircle_m(a, b, earth.semi_major_m);
  const double flattening = 1.0 / earth.inverse_flattening;
  const double eccentricity2 = flattening * (2.0 - flattening);
  const auto position_m = [&](const volume::EarthPlace& place) {
    const glm::dvec3 up = Direction(place.latitude_deg, place.longitude_deg);
    const double normal_m = earth.semi_major_m / std::sqrt(1.0 - eccentricity2 * up.z * up.z);
    return normal_m * up * glm::dvec3(1.0, 1.0, 1.0 - eccentricity2);
  };
  const double chord_m = glm::distance(position_m(a), position_m(b));
  const double diameter_m = 2.0 * MeanRadius_m(earth);
  return diameter_m * std::asin(std::min(chord_m / diameter_m, 1.0));
}

absl::StatusOr<ModelColumns> ModelColumns::Of(const ColumnPlaces& places) {
  if (std::min(places.columns.x, places.columns.y) < 1) {
    return absl::InvalidArgumentError("the model has no columns");
  }
  ModelColumns model;
  model.places_ = places;
  model.earth_ = absl::StrFormat("+R=%.12g", places.radius_m);
  THUNDERHEAD_RETURN_IF_ERROR(places.projection.empty() ? model.CheckListed()
                                                        : model.CheckProjected());
  return model;
}

absl::Status ModelColumns::CheckProjected() {
  const glm::dvec2& step = places_.step;
  const glm::dvec2& first = places_.first;
  if (!(step.x > 0.0) || !(step.y > 0.0) || !std::isfinite(step.x + step.y + first.x + first.y)) {
    return absl::InvalidArgumentError(absl::StrCat("the steps between columns are ", step.x,
                                                   " and ", step.y, ", not above 0; correct them"));
  }
  earth_ = EarthOf(places_.projection);
  if (IsInDegrees(ProjectionWords(places_.projection))) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckDegrees(places_));
    ToMetres(places_);
    const double radius_m = ProjectionWords(places_.projection).Number("R").value_or(0.0);
    pole_m_ = radius_m * glm::radians(90.0);
  }
  if (earth_.empty()) earth_ = EarthOf(places_.projection);
  if (earth_.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("the map projection '", places_.projection,
                     "' does not give the size of the Earth; add its radius"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(volume::MapProjection map,
                               volume::MapProjection::Open(places_.projection));
  map_ = std::move(map);
  return absl::OkStatus();
}

absl::Status ModelColumns::CheckListed() const {
  const auto count = static_cast<std::size_t>(Count().x) * static_cast<std::size_t>(Count().y);
  if (places_.latitude_deg.size() != count || places_.longitude_deg.size() != count) {
    return absl::InvalidArgumentError("there is not one latitude and longitude a column");
  }
  if (std::min(Count().x, Count().y) < 2) {
    return absl::InvalidArgumentError(
        "the distance between columns is unknown, because there is only one along an axis; give a "
        "map projection, or a file with more columns");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const float latitude_deg = places_.latitude_deg[i];
    if (IsPlaceOnEarth(latitude_deg, places_.longitude_deg[i])) continue;
    const auto width = static_cast<std::size_t>(Count().x);
    return absl::InvalidArgumentError(
        absl::StrCat("the latitude and longitude of column (", i % width, ", ", i / width, ") are ",
                     latitude_deg, " and ", places_.longitude_deg[i],
                     "; cut a region in which each column has a place"));
  }
  return absl::OkStatus();
}

glm::dvec2 ModelColumns::PlaneAt(const glm::dvec2& position) const {
  return places_.first + position * places_.step;
}

std::optional<volume::EarthPlace> ModelColumns::PlaceAt(const glm::dvec2& position) const {
  if (!IsProjected()) return BetweenColumns(position);
  glm::dvec2 plane_m = PlaneAt(position);
  if (pole_m_.has_value()) plane_m.y = std::clamp(plane_m.y, -*pole_m_, *pole_m_);
  return map_->PlaceOf(plane_m);
}

// Interpolates directions from the Earth's centre, which works across poles and the date line.
std::optional<volume::EarthPlace> ModelColumns::BetweenColumns(const glm::dvec2& position) const {
  const glm::ivec2 low = glm::clamp(glm::ivec2(glm::floor(position)), glm::ivec2(0), Count() - 2);
  const glm::dvec2 share = position - glm::dvec2(low);
  const auto at = [&](int x, int y) {
    const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(Count().x) +
                          static_cast<std::size_t>(x);
    return Direction(places_.latitude_deg[i], places_.longitude_deg[i]);
  };
  const glm::dvec3 between =
      glm::mix(glm::mix(at(low.x, low.y), at(low.x + 1, low.y), share.x),
               glm::mix(at(low.x, low.y + 1), at(low.x + 1, low.y + 1), share.x), share.y);
  const double length = glm::length(between);
  if (!(length > 0.0)) return std::nullopt;
  return volume::EarthPlace{glm::degrees(std::atan2(between.z, std::hypot(between.x, between.y))),
                            glm::degrees(std::atan2(between.y, between.x))};
}

}  // namespace thunderhead::storm_files
