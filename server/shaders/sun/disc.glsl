// The sun's disc.
const float kDiscRadius_rad = 0.00465;  // physics::kSunRadius_rad
const float kMaxRadiance = 6e4;  // maximum radiance that a half float can store

uniform float pixel_rad;  // angle over which the edge of the disc is blurred

// Returns the disc's radiance at an angle from its centre, divided by its irradiance. The disc is uniformly bright.
float disc_radiance(float angle_rad) {
  float inside = clamp(0.5 + (kDiscRadius_rad - angle_rad) / pixel_rad, 0.0, 1.0);
  return inside / (3.14159265 * kDiscRadius_rad * kDiscRadius_rad);
}

// Returns the angle between two directions from its haversine.
float angle_of(float haversine) { return 2.0 * asin(sqrt(min(haversine, 1.0))); }
