// The position of a top-down picture in the map projection of its model, by PROJ. Plane coordinates
// are metres east and north of the projection's origin. Storm coordinates are metres from the
// middle of the domain. The two differ only by a shift, because a model's grid is regular in its
// projection.
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

// A map projection. Each object is used by one thread.
class MapProjection {
 public:
  // Opens a projection in PROJ's notation, such as "+proj=lcc +lat_1=30 ...". INVALID_ARGUMENT if
  // PROJ does not know it.
  static absl::StatusOr<MapProjection> Open(const std::string& text);

  // Returns the place's plane coordinates in metres. They are not finite for a place outside the
  // map.
  glm::dvec2 PlaneOf_m(const Place& place) const;
  Place PlaceOf(const glm::dvec2& plane_m) const;

  // Return the projection's definition as well-known text: GdalText in GDAL's variant, IsoText by
  // ISO 19162.
  std::string GdalText() const;
  std::string IsoText() const;

  // Return a parameter such as "lat_1". If it is missing, Text returns an empty string and Number
  // 0.
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

// The position of a picture with north up. Coordinates are plane coordinates, or metres from the
// middle of the domain if there is no projection.
struct MapPlace {
  std::string projection;
  glm::dvec2 upper_left_m{0.0};  // upper left corner of the first pixel, not its centre
  glm::dvec2 pixel_m{0.0};       // width and height of a pixel

  // Returns the coordinates of a pixel's centre. Columns and rows are counted from the upper left.
  glm::dvec2 MiddleOf_m(int column, int row) const {
    return {upper_left_m.x + (column + 0.5) * pixel_m.x, upper_left_m.y - (row + 0.5) * pixel_m.y};
  }
};

// Returns the six lines of a world file, a text file next to a picture that gives GIS programs its
// position.
std::string WorldFile(const MapPlace& place);

}  // namespace thunderhead::product
