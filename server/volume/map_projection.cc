#include "volume/map_projection.h"

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "glm/geometric.hpp"
#include "glm/gtc/constants.hpp"
#include "glm/trigonometric.hpp"

namespace thunderhead::volume {
namespace {

constexpr double kQuarter = glm::half_pi<double>() / 2.0;
// The latitude in radians beyond which a conic or Mercator projection has no place.
constexpr double kPole = glm::half_pi<double>() - 1e-9;

using Parameters = std::map<std::string, std::string, std::less<>>;

// Returns "+a=1 +b" as a = "1", b = "".
Parameters ParametersOf(std::string_view proj) {
  Parameters parameters;
  for (const absl::string_view word :
       absl::StrSplit(absl::string_view(proj.data(), proj.size()), ' ', absl::SkipEmpty())) {
    const std::pair<absl::string_view, absl::string_view> parts =
        absl::StrSplit(word.substr(word[0] == '+' ? 1 : 0), absl::MaxSplits('=', 1));
    parameters.emplace(std::string(parts.first), std::string(parts.second));
  }
  return parameters;
}

double NumberOf(const Parameters& parameters, std::string_view name) {
  const auto at = parameters.find(name);
  double value = 0.0;
  if (at == parameters.end() || !absl::SimpleAtod(at->second, &value)) return std::nan("");
  return value;
}

// Returns the tangent of half the angular distance from the south pole. Its logarithm is the y
// coordinate of the Mercator projection.
double Stretched(double latitude) { return std::tan(kQuarter + latitude / 2.0); }

double Wrapped_deg(double degrees) { return std::remainder(degrees, 360.0); }

}  // namespace

std::optional<MapProjection> MapProjection::Of(std::string_view proj, const EarthPlace& middle) {
  const Parameters parameters = ParametersOf(proj);
  const auto radians = [&](std::string_view name) {
    return glm::radians(NumberOf(parameters, name));
  };
  const auto kind = parameters.find("proj");
  if (kind == parameters.end()) return std::nullopt;
  MapProjection map;
  map.radius_m_ = NumberOf(parameters, "R");
  map.longitude0_deg_ = NumberOf(parameters, "lon_0");
  if (kind->second == "lcc") {
    map.kind_ = Kind::kConic;
    const double first = radians("lat_1");
    const double second = radians("lat_2");
    map.cone_ = std::abs(first - second) < 1e-9
                    ? std::sin(first)
                    : std::log(std::cos(first) / std::cos(second)) /
                          std::log(Stretched(second) / Stretched(first));
    map.scale_m_ =
        map.radius_m_ * std::cos(first) * std::pow(Stretched(first), map.cone_) / map.cone_;
    map.origin_m_ = map.scale_m_ / std::pow(Stretched(radians("lat_0")), map.cone_);
  } else if (kind->second == "stere") {
    map.kind_ = Kind::kPolar;
    map.pole_ = NumberOf(parameters, "lat_0") < 0.0 ? -1.0 : 1.0;
    map.scale_m_ = map.radius_m_ * (1.0 + std::sin(map.pole_ * radians("lat_ts")));
  } else if (kind->second == "merc") {
    map.kind_ = Kind::kMercator;
    map.scale_m_ = map.radius_m_ * std::cos(radians("lat_ts"));
  } else if (kind->second == "eqc") {
    map.kind_ = Kind::kPlateCarree;
    map.latitude0_ = radians("lat_0");
    map.scale_m_ = map.radius_m_ * std::cos(radians("lat_ts"));
  } else {
    return std::nullopt;
  }
  const std::optional<glm::dvec2> middle_m = map.Project(middle);
  if (!middle_m.has_value() || !(map.radius_m_ > 0.0) || map.scale_m_ == 0.0) return std::nullopt;
  map.middle_m_ = *middle_m;
  return map;
}

std::optional<EarthPlace> MapProjection::PlaceOf(const glm::dvec2& world_m) const {
  return Unproject(middle_m_ + world_m);
}

std::optional<glm::dvec2> MapProjection::WorldOf(const EarthPlace& place) const {
  const std::optional<glm::dvec2> map_m = Project(place);
  if (!map_m.has_value()) return std::nullopt;
  return *map_m - middle_m_;
}

std::optional<glm::dvec2> MapProjection::Project(const EarthPlace& place) const {
  const double latitude = glm::radians(place.latitude_deg);
  const double turn = glm::radians(Wrapped_deg(place.longitude_deg - longitude0_deg_));
  glm::dvec2 map_m(0.0);
  switch (kind_) {
    case Kind::kConic: {
      if (std::abs(latitude) > kPole) return std::nullopt;
      const double from_tip_m = scale_m_ / std::pow(Stretched(latitude), cone_);
      map_m = {from_tip_m * std::sin(cone_ * turn),
               origin_m_ - from_tip_m * std::cos(cone_ * turn)};
      break;
    }
    case Kind::kPolar: {
      if (pole_ * latitude < -kPole) return std::nullopt;
      const double from_pole_m = scale_m_ / Stretched(pole_ * latitude);
      map_m = {from_pole_m * std::sin(turn), -pole_ * from_pole_m * std::cos(turn)};
      break;
    }
    case Kind::kMercator:
      if (std::abs(latitude) > kPole) return std::nullopt;
      map_m = {scale_m_ * turn, scale_m_ * std::log(Stretched(latitude))};
      break;
    case Kind::kPlateCarree:
      map_m = {scale_m_ * turn, radius_m_ * (latitude - latitude0_)};
      break;
  }
  if (!std::isfinite(map_m.x) || !std::isfinite(map_m.y)) return std::nullopt;
  return map_m;
}

std::optional<EarthPlace> MapProjection::Unproject(const glm::dvec2& map_m) const {
  double latitude = 0.0;
  double turn = 0.0;
  switch (kind_) {
    case Kind::kConic: {
      // A cone with its tip in the south has negative scale, origin and distance.
      const double side = std::copysign(1.0, cone_);
      const glm::dvec2 from_tip_m = side * glm::dvec2(map_m.x, origin_m_ - map_m.y);
      const double distance_m = side * glm::length(from_tip_m);
      if (distance_m == 0.0) return std::nullopt;
      latitude = 2.0 * std::atan(std::pow(scale_m_ / distance_m, 1.0 / cone_)) - 2.0 * kQuarter;
      turn = std::atan2(from_tip_m.x, from_tip_m.y) / cone_;
      if (std::abs(turn) > glm::pi<double>()) return std::nullopt;
      break;
    }
    case Kind::kPolar: {
      const double distance_m = glm::length(map_m);
      latitude = pole_ * (2.0 * kQuarter - 2.0 * std::atan(distance_m / scale_m_));
      turn = distance_m > 0.0 ? std::atan2(map_m.x, -pole_ * map_m.y) : 0.0;
      break;
    }
    case Kind::kMercator:
      latitude = 2.0 * std::atan(std::exp(map_m.y / scale_m_)) - 2.0 * kQuarter;
      turn = map_m.x / scale_m_;
      break;
    case Kind::kPlateCarree:
      latitude = latitude0_ + map_m.y / radius_m_;
      turn = map_m.x / scale_m_;
      if (std::abs(latitude) > 2.0 * kQuarter) return std::nullopt;
      break;
  }
  const EarthPlace place{glm::degrees(latitude), Wrapped_deg(longitude0_deg_ + glm::degrees(turn))};
  if (!std::isfinite(place.latitude_deg) || !std::isfinite(place.longitude_deg)) {
    return std::nullopt;
  }
  return place;
}

}  // namespace thunderhead::volume
