// The sun's disc.
const float kDiscRadius_rad = 0.00465;  // physics::kSunRadius_rad
const float kMaxRadiance = 6e4;         // that a half float holds

uniform float pixel_rad;  // over which the disc's edge is spread

// Its radiance at an angle from its middle, over its irradiance; it is evenly bright.
float disc_radiance(float angle_rad) {
  float inside = clamp(0.5 + (kDiscRadius_rad - angle_rad) / pixel_rad, 0.0, 1.0);
  return inside / (3.14159265 * kDiscRadius_rad * kDiscRadius_rad);
}

// The angle between two directions whose haversine is given.
float angle_of(float haversine) { return 2.0 * asin(sqrt(min(haversine, 1.0))); }
