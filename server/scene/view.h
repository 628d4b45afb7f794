// The geometry of a picture: which ray each pixel stands for. Derived from a scene's camera and the
// ground under it.
//
// World coordinates are flat. Orbit and top-down cameras take them as they are. A spotter stands on
// a round Earth: seen from its own place the storm is lowered and tilted as if it stood on the
// plane that touches the Earth below the storm's middle. Rays stay straight lines in world
// coordinates. The storm itself stays flat: what is r away from its middle stands r^2 / 2R too
// high, 15 m at 15 km and 170 m at 50 km, however far the spotter is.
#pragma once

#include "glm/mat3x3.hpp"
#include "glm/vec3.hpp"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

// The radius of a sphere without air above which straight rays rise as real ones do above the
// Earth: 7/6 of the mean radius, the surveyors' coefficient of refraction (1/7) for visible light.
// Radar's 4/3 is for microwaves, which water vapour bends more.
constexpr double kEffectiveEarthRadius_m = 7.0 / 6.0 * 6.371e6;

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
  double ground_curvature_per_m = 0.0;  // of the level ground that the eye sees; 0 is flat

  bool Orthographic() const { return half_width_m > 0.0; }
};

// Where a spotter stands: what of a storm the camera depends on.
struct Site {
  double ground_height_m = 0.0;  // above sea level
  glm::dvec2 storm_middle_m{0.0};
};

// The unit vector that points to azimuth (clockwise from north) and elevation.
glm::dvec3 Direction(double azimuth_deg, double elevation_deg);

// The view of a camera on a picture of the given aspect ratio (width over height).
View ViewOf(const OrbitCamera& camera, double aspect_ratio);
View ViewOf(const SpotterCamera& camera, const Site& site, double aspect_ratio);
View ViewOf(const TopDownCamera& camera, double aspect_ratio);

// The view of the scene's camera on its storm.
View ViewOf(const Scene& scene, const volume::HydrometeorFields& fields);

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
