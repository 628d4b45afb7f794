#include "product/map_place.h"

#include "absl/strings/str_format.h"

namespace thunderhead::product {

std::string WorldFile(const MapPlace& place) {
  const glm::dvec2 first_m = place.MiddleOf_m(0, 0);
  return absl::StrFormat("%.10f\n0.0000000000\n0.0000000000\n%.10f\n%.10f\n%.10f\n",
                         place.pixel_m.x, -place.pixel_m.y, first_m.x, first_m.y);
}

}  // namespace thunderhead::product
