// A small picture of a medium without sky and ground, drawn by one technique (light volume,
// half-angle or metaballs). Each picture is checked: all numbers are finite, no radiance is below
// 0, and transmittance and light are from 0 to 1. Uses the current GL context.
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
  double optical_depth = 1.0;  // vertical, with the default particle radius
  enum class Shape {
    kFull,   // homogeneous, up to the domain's faces
    kLayer,  // the middle half of the height; extinction falls to zero over one cell at its faces
    kRound,  // a Gaussian around the middle
  } shape = Shape::kFull;
};

std::shared_ptr<volume::HydrometeorFields> FieldsOf(const Box& box);

// Returns a Gaussian cloud in a cube of 4 km, with that optical depth through its middle.
std::shared_ptr<const volume::HydrometeorFields> SmoothCloud(double optical_depth);

struct Look {
  double view_azimuth_deg = 200.0;  // of the camera, seen from the target
  double view_elevation_deg = 89.9;
  double sun_azimuth_deg = 70.0;
  double sun_elevation_deg = 89.9;
  double distance_in_boxes =
      5.0;  // of the camera from the middle, in units of the box's longest side
  double field_of_view_deg = 2.0;
  int side_px = 9;  // odd, so that one pixel lies in the middle
  // Makes the light volume's buffers float; those of other techniques always are.
  bool single_precision = false;
};

struct Seen {
  double radiance = 0.0;       // red of the middle pixel, in units of the sun's irradiance
  double transmittance = 1.0;  // of the middle pixel
  std::vector<float> eye;      // four floats per pixel
  double least_light = 1.0;    // smallest share of sunlight in the light's buffers; 1 for metaballs
  std::string unsound;         // the first invalid value; empty if there is none
};

class Probe {
 public:
  // Draws with scene.rendering and scene.fields; the camera looks at the middle of the domain.
  absl::StatusOr<Seen> Draw(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                            const Look& look);

 private:
  std::shared_ptr<gl::ProgramCache> programs_ = std::make_shared<gl::ProgramCache>();
};

}  // namespace thunderhead::measure
