// The geometry of a picture: which ray each pixel stands for. Derived from a scene's camera and the
// ground under it.
//
// World coordinates are those of the plane that touches the round Earth below the storm's middle:
// the ground falls away from there as d^2 / 2R, and where an eye stands off it, its upright leans
// with it. So a distant storm sinks below a spotter's horizon while rays stay straight lines. The
// storm itself stays flat: what is r away from its middle stands r^2 / 2R too high, 15 m at 15 km
// and 170 m at 50 km, however far the eye is. A top-down camera sees a flat world.
#pragma once

#include "glm/mat3x3.hpp"
#include "glm/vec3.hpp"
#include "physics/atmosphere.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

using physics::kEffectiveEarthRadius_m;

// `right`, `up` and `forward` are unit vectors. The ray through normalised device coordinates (x,
// y) starts at eye_m + x half_width_m right + y half_height_m up and has the direction forward + x
// tan_half_width right + y tan_half_height up. In perspective the half sizes are zero, for parallel
// rays the tangents.
struct View {
  glm::dvec3 eye_m{0.0};
  glm::dvec3 right{1.0, 0.0, 0.0};
  glm::dvec3 up{0.0, 0.0, 1.0};
  glm::dvec3 forward{0.0, 1.0, 0.0};
  double tan_half_width = 1.0;
  double tan_half_height = 1.0;
  double half_width_m = 0.0;
  double half_height_m = 0.0;

  // East, north and up where the eye is, from world directions.
  glm::dmat3 local_from_world{1.0};
  double altitude_m = 0.0;              // of the eye above sea level
  glm::dvec2 touch_m{0.0};              // where the world's plane touches the Earth
  double ground_curvature_per_m = 0.0;  // away from there; 0 is flat

  bool Orthographic() const { return half_width_m > 0.0; }
};

// `direction` has the length 1.
struct ViewRay {
  glm::dvec3 origin_m{0.0};
  glm::dvec3 direction{0.0, 1.0, 0.0};
};
// Through normalised device coordinates.
ViewRay RayThrough(const View& view, double x, double y);

// Where a storm is: what of it a view depends on.
struct Site {
  double ground_height_m = 0.0;  // above sea level, under a spotter
  glm::dvec2 storm_middle_m{0.0};
};

// The unit vector that points to azimuth (clockwise from north) and elevation.
glm::dvec3 Direction(double azimuth_deg, double elevation_deg);

// The view of a camera on a picture of the given aspect ratio (width over height).
View ViewOf(const OrbitCamera& camera, double aspect_ratio);  // on a flat Earth
View ViewOf(const OrbitCamera& camera, const Site& site, double aspect_ratio);
View ViewOf(const SpotterCamera& camera, const Site& site, double aspect_ratio);
View ViewOf(const TopDownCamera& camera, double aspect_ratio);

// Where the storm is, for a spotter at `place_m`.
Site SiteOf(const volume::HydrometeorFields& fields, const glm::dvec2& place_m);

// The view of the scene's camera on its storm.
View ViewOf(const Scene& scene, const volume::HydrometeorFields& fields);

// The elevation from which an orbit shows the box `low_m` to `high_m` well: 4 degrees where it is
// at least a tenth as high as wide, as single storms are, 35 where it is at most a fiftieth.
double FramingElevation_deg(const glm::dvec3& low_m, const glm::dvec3& high_m);

// The camera that frames the box `low_m` to `high_m` whole, standing and looking as `camera` does.
OrbitCamera Framing(OrbitCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m,
                    double aspect_ratio);
// `camera` gives the azimuth it looks to and the focal length.
SpotterCamera Framing(SpotterCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m,
                      double aspect_ratio);
TopDownCamera Framing(TopDownCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m,
                      double aspect_ratio);

// The spotter where it stands, its head turned to the middle of the box, the horizon in sight.
SpotterCamera LookingAt(SpotterCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m);

}  // namespace thunderhead::scene
