// Where a top-down picture lies in its model's map projection, by PROJ. Plane coordinates are
// metres east and north of the projection's origin, those of the storm metres from the middle of
// the domain: a model's grid is regular in its projection, so one is the other moved.
#pragma once

#include <proj.h>

#include <map>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "glm/vec2.hpp"

namespace thunderhead::product {

struct Place {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

// Used by one thread.
class MapProjection {
 public:
  // As PROJ writes it, such as "+proj=lcc +lat_1=30 ...". INVALID_ARGUMENT if PROJ does not know
  // it.
  static absl::StatusOr<MapProjection> Open(const std::string& text);

  // Metres in the plane; not finite for a place that is not on the map.
  glm::dvec2 PlaneOf_m(const Place& place) const;
  Place PlaceOf(const glm::dvec2& plane_m) const;

  // Its definition as well-known text: as GDAL reads it, or by ISO 19162.
  std::string GdalText() const;
  std::string IsoText() const;

  // A parameter such as "lat_1"; empty if there is none.
  std::string Text(const std::string& parameter) const;
  double Number(const std::string& parameter) const;

 private:
  struct Deleter {
    void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
    void operator()(PJ* projection) const { proj_destroy(projection); }
  };

  MapProjection() = default;
  std::string WellKnownText(PJ_WKT_TYPE type) const;

  std::unique_ptr<PJ_CONTEXT, Deleter> context_;
  std::unique_ptr<PJ, Deleter> transform_;
  std::unique_ptr<PJ, Deleter> system_;
  std::map<std::string, std::string> parameters_;
};

// A picture with north up. Without a projection, metres are those from the middle of the domain.
struct MapPlace {
  std::string projection;
  glm::dvec2 upper_left_m{0.0};  // the corner, not a pixel's middle
  glm::dvec2 pixel_m{0.0};       // width and height

  // Coordinates of the middle of a pixel, counted from the upper left.
  glm::dvec2 MiddleOf_m(int column, int row) const {
    return {upper_left_m.x + (column + 0.5) * pixel_m.x, upper_left_m.y - (row + 0.5) * pixel_m.y};
  }
};

// The six lines of a world file, as GIS programs read it beside a picture.
std::string WorldFile(const MapPlace& place);

}  // namespace thunderhead::product
