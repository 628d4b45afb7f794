// A small picture of a medium without sky and ground, drawn by one technique (light volume,
// half-angle slicing or metaballs). Each picture is checked: all numbers are finite, no radiance is
// below 0, and transmittance and light are from 0 to 1. The class uses the current GL context.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gl/program.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::measure {

// A box of cloud water standing on z = 0, in a domain of the same size.
struct Box {
  glm::ivec3 cells{16};
  glm::dvec3 size_m{4000.0, 4000.0, 1000.0};
  double optical_depth = 1.0;  // vertical optical depth for the default particle radius
  enum class Shape {
    kFull,  // homogeneous, up to the faces of the domain
    // The middle half of the height. At its faces, the extinction falls to zero over one cell.
    kLayer,
    kRound,  // a Gaussian around the middle
  } shape = Shape::kFull;
};

std::shared_ptr<volume::HydrometeorFields> FieldsOf(const Box& box);

// Returns a Gaussian cloud in a cube of 4 km. The optical depth is that of a ray through its
// middle.
std::shared_ptr<const volume::HydrometeorFields> SmoothCloud(double optical_depth);

struct Look {
  double view_azimuth_deg = 200.0;  // azimuth of the camera as seen from the target
  double view_elevation_deg = 89.9;
  double sun_azimuth_deg = 70.0;
  double sun_elevation_deg = 89.9;
  double distance_in_boxes =
      5.0;  // camera's distance from the middle, in units of the box's longest side
  double field_of_view_deg = 2.0;
  int side_px = 9;  // odd, so that one pixel lies in the middle
  // Uses 32-bit floats in the light volume's buffers. The buffers of other techniques always do.
  bool single_precision = false;
};

struct Seen {
  double radiance = 0.0;       // red radiance of the middle pixel, in units of the sun's irradiance
  double transmittance = 1.0;  // transmittance of the middle pixel
  std::vector<float> eye;      // radiance and transmittance of all pixels, four floats a pixel
  // Smallest share of sunlight in the light buffers. It is always 1 for metaballs.
  double least_light = 1.0;
  std::string unsound;  // the first invalid value; empty if there is none
};

class Probe {
 public:
  // Draws with scene.rendering and scene.fields. The camera looks at the middle of the domain.
  // Returns UNIMPLEMENTED for other techniques than those above.
  absl::StatusOr<Seen> Draw(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                            const Look& look);

 private:
  std::shared_ptr<gl::ProgramCache> programs_ = std::make_shared<gl::ProgramCache>();
};

}  // namespace thunderhead::measure
