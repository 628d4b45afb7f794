// Converts between world coordinates and places on Earth with PROJ, in the map projection of a
// storm's grid. World coordinates are metres along the axes of that grid. Their y axis is therefore
// the grid's north, which differs from true north except at places such as a Lambert grid's central
// meridian. PROJ opens no file here, neither its database nor its settings, so this code also works
// in a confined process.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "glm/vec2.hpp"
#include "volume/projection_text.h"

namespace thunderhead::volume {

struct EarthPlace {
  double latitude_deg = 0.0;   // north
  double longitude_deg = 0.0;  // east, -180 to 180

  bool operator==(const EarthPlace&) const = default;
};

// The figure of the Earth: an ellipsoid, or a sphere with an inverse flattening of 0.
struct EarthFigure {
  double semi_major_m = 0.0;
  double inverse_flattening = 0.0;
};

// A map projection. It is thread-safe: calls from several threads wait for each other.
class MapProjection {
 public:
  // Opens a projection in PROJ's notation (see ProjectionText). World coordinates are metres east
  // and north of the projection's own origin. Returns INVALID_ARGUMENT if the text is not accepted.
  static absl::StatusOr<MapProjection> Open(std::string_view proj);
  // Opens the projection of a grid whose middle is at `middle`. World coordinates are metres from
  // that middle. Returns INVALID_ARGUMENT if the text is not accepted or the middle is not on the
  // map.
  static absl::StatusOr<MapProjection> Of(std::string_view proj, const EarthPlace& middle);

  MapProjection(MapProjection&&) noexcept;
  MapProjection& operator=(MapProjection&&) noexcept;
  ~MapProjection();

  // Returns the place at these world coordinates, or nothing if they lie beyond the map.
  std::optional<EarthPlace> PlaceOf(const glm::dvec2& world_m) const;
  // Returns the world coordinates of a place, or nothing if it is not on the map. On a map that
  // goes around the Earth, they are the ones nearest to the origin.
  std::optional<glm::dvec2> WorldOf(const EarthPlace& place) const;

  // Returns the direction of true north at a place, in degrees clockwise from the grid's north (the
  // world's y axis), -180 to 180. East of the central meridian of a Lambert grid in the northern
  // hemisphere it is negative. An azimuth from true north plus this angle is an azimuth in the
  // world. Returns nothing if the place is not on the map.
  std::optional<double> TrueNorth_deg(const EarthPlace& place) const;

  // Returns the origin of world coordinates in the projection's own coordinates, in metres.
  const glm::dvec2& Origin_m() const { return origin_m_; }
  const ProjectionText& Text() const { return text_; }
  EarthFigure Figure() const;

  // Returns the projection as well-known text, by ISO 19162 or in GDAL's variant of its first
  // version. Returns an empty text if that format cannot express the projection.
  enum class WellKnown { kIso, kGdal };
  std::string WellKnownText(WellKnown variant) const;

 private:
  class Proj;

  MapProjection(ProjectionText text, std::unique_ptr<Proj> proj);
  std::optional<glm::dvec2> Project(const EarthPlace& place) const;
  double FullCircle_m() const;

  ProjectionText text_;
  std::unique_ptr<Proj> proj_;
  // The distance on the map around the Earth along a parallel, if it is the same on all parallels.
  std::optional<double> full_circle_m_;
  glm::dvec2 origin_m_{0.0};
};

// Returns the projection of a coordinate reference system in well-known text, in PROJ's notation.
// Returns INVALID_ARGUMENT if it is not a projection that ProjectionText accepts.
absl::StatusOr<std::string> ProjectionOfWellKnownText(const std::string& text);

// Returns the longitude of a prime meridian that has a name, such as "Paris", in degrees east of
// Greenwich. Returns nothing if PROJ does not know the name. Letters may be of either case.
std::optional<double> PrimeMeridianNamed(std::string_view name);

// Returns the longitude of the prime meridian of a coordinate reference system in well-known text,
// in degrees east of Greenwich. Returns nothing if PROJ cannot parse the text.
std::optional<double> PrimeMeridianOfWellKnownText(const std::string& text);

}  // namespace thunderhead::volume
