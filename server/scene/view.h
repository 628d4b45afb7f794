// The geometry of a picture: the ray of each pixel. It follows from a scene's camera and the ground
// under the camera.
//
// World coordinates are those of the plane that touches the round Earth below the storm's middle.
// At a distance d from that point the ground is d^2 / 2R below the plane, where R is the Earth's
// radius. The vertical at a distant eye is tilted accordingly. A distant storm therefore sinks
// below a spotter's horizon although rays stay straight lines. The storm itself is not curved, so
// its parts at a distance r from its middle are r^2 / 2R too high. This error is 15 m at r = 15 km
// and 170 m at r = 50 km, however far away the eye is. A top-down camera sees a flat world.
#pragma once

#include "glm/mat3x3.hpp"
#include "glm/vec3.hpp"
#include "physics/atmosphere.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

using physics::kEffectiveEarthRadius_m;

// The position and orientation of a camera. `right`, `up` and `forward` are unit vectors. The ray
// through normalised device coordinates (x, y) starts at eye_m + x half_width_m right + y
// half_height_m up. Its direction is forward + x tan_half_width right + y tan_half_height up. With
// perspective `half_width_m` and `half_height_m` are zero. With parallel rays the two tangents are
// zero.
struct View {
  glm::dvec3 eye_m{0.0};
  glm::dvec3 right{1.0, 0.0, 0.0};
  glm::dvec3 up{0.0, 0.0, 1.0};
  glm::dvec3 forward{0.0, 1.0, 0.0};
  double tan_half_width = 1.0;
  double tan_half_height = 1.0;
  double half_width_m = 0.0;
  double half_height_m = 0.0;

  // Transforms world directions to east, north and up at the eye.
  glm::dmat3 local_from_world{1.0};
  double altitude_m = 0.0;  // height of the eye above sea level
  glm::dvec2 touch_m{0.0};  // the point where the plane of world coordinates touches the Earth
  // 1/R of the Earth, by which the ground falls away from touch_m; 0 for a flat world
  double ground_curvature_per_m = 0.0;

  bool Orthographic() const { return half_width_m > 0.0; }
};

// A ray with a `direction` of length 1.
struct ViewRay {
  glm::dvec3 origin_m{0.0};
  glm::dvec3 direction{0.0, 1.0, 0.0};
};
// Returns the ray through normalised device coordinates.
ViewRay RayThrough(const View& view, double x, double y);

// The values of a storm that a view depends on.
struct Site {
  double ground_height_m = 0.0;  // height above sea level of the ground under a spotter
  glm::dvec2 storm_middle_m{0.0};
};

// Returns the unit vector towards azimuth (clockwise from north) and elevation.
glm::dvec3 Direction(double azimuth_deg, double elevation_deg);

// Returns the view of a camera on a picture of the given aspect ratio (width over height).
View ViewOf(const OrbitCamera& camera, double aspect_ratio);  // view on a flat Earth
View ViewOf(const OrbitCamera& camera, const Site& site, double aspect_ratio);
View ViewOf(const SpotterCamera& camera, const Site& site, double aspect_ratio);
View ViewOf(const TopDownCamera& camera, double aspect_ratio);

// Returns the site of the storm for a spotter at `place_m`.
Site SiteOf(const volume::HydrometeorFields& fields, const glm::dvec2& place_m);

// Returns the view of the scene's camera on its storm.
View ViewOf(const Scene& scene, const volume::HydrometeorFields& fields);

// Returns an elevation from which an orbit camera shows the box `low_m` to `high_m` well. The
// elevation is 4 degrees if the box's height is at least a tenth of its width, as for single
// storms. It is 35 degrees if the height is at most a fiftieth of the width.
double FramingElevation_deg(const glm::dvec3& low_m, const glm::dvec3& high_m);

// Returns a camera that shows the whole box `low_m` to `high_m` from the direction of `camera`.
OrbitCamera Framing(OrbitCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m,
                    double aspect_ratio);
// Returns a spotter camera from which the whole box is visible. `camera` gives the azimuth in which
// the spotter looks and the focal length.
SpotterCamera Framing(SpotterCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m,
                      double aspect_ratio);
TopDownCamera Framing(TopDownCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m,
                      double aspect_ratio);

// Returns the spotter camera at its own place, turned to the middle of the box, with the horizon in
// the picture.
SpotterCamera LookingAt(SpotterCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m);

}  // namespace thunderhead::scene
