// The ground's cover where a view ray meets it: crop fields on the section grid of the Great Plains, lines, and
// distance rings. All values are averaged over a footprint, so that nothing is finer than a pixel. The footprint is the
// axis-parallel rectangle of ground that a pixel shows. Lengths are in metres. The file compiles as GLSL and as C++
// (physics/field_pattern.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

// Lengths of the Public Land Survey System. A section is a square of one mile. It has four quarters, each with four
// cells of 40 acres. Fields consist of cells. The map of cells is periodic.
const float kSection_m = 1609.344f;
const float kQuarter_m = 804.672f;
const float kFieldCell_m = 402.336f;
const int kFieldMapCells = 256;

const float kRoad_m = 12.0f;          // width of the road on each section line
const float kPivotRadius_m = 395.0f;  // radius of the circle that a centre pivot waters

// Lengths of the grain, which is uneven soil and plants within a field. The grain has the same kind of map as the
// cells, but smaller and rotated, so that it does not follow the roads.
const float kGrainCell_m = 0.8f;
const float kCoarsestGrain_m = 51.2f;

// Returns the rectangle of ground that a pixel shows. The pixel is `across_m` wide at that distance. Its ray of unit
// direction `ray` meets level ground at an angle with the sine `grazing`.
PHYSICS_FUNCTION vec2 ground_footprint(vec3 ray, float grazing, float across_m) {
  float level = length(vec2(ray));
  vec2 along = level > 1e-4f ? abs(vec2(ray)) / level : vec2(1.0f, 0.0f);
  float along_m = across_m / max(grazing, 1e-3f);
  return vec2(along_m * along.x + across_m * along.y, along_m * along.y + across_m * along.x);
}

// Returns the place at which to look up a map of cells with linear filtering. Each cell then looks uniform, and its
// edges are as wide as the footprint. All values are in units of cells.
PHYSICS_FUNCTION vec2 sharp_cell(vec2 place, vec2 footprint) {
  vec2 corner = floor(place - 0.5f);
  vec2 within = (place - 0.5f - corner - 0.5f) / clamp(footprint, vec2(1e-3f), vec2(1.0f)) + 0.5f;
  return corner + 0.5f + clamp(within, vec2(0.0f), vec2(1.0f));
}

// Returns the level of the mip chain whose texels are as large as the footprint. `footprint` is in texels.
PHYSICS_FUNCTION float mip_level(vec2 footprint) { return log2(max(max(footprint.x, footprint.y), 1.0f)); }

// Returns the length that stripes cover in the interval from -period / 2 to x. There is a stripe of
// width `stripe` around each multiple of `period`.
PHYSICS_FUNCTION float striped_length(float x, float period, float stripe) {
  float periods = x / period + 0.5f;
  float whole = floor(periods);
  return whole * stripe + clamp((periods - whole - 0.5f) * period + 0.5f * stripe, 0.0f, stripe);
}

// Returns the share of a footprint that stripes cover, along one axis.
PHYSICS_FUNCTION float stripes(float x, float footprint, float period, float stripe) {
  float width = max(footprint, 0.5f);  // a smaller width would cause rounding errors
  // The position is relative to the nearest multiple of the period, so that the difference below is between small
  // numbers.
  float near = x - period * floor(x / period + 0.5f);
  return (striped_length(near + 0.5f * width, period, stripe) - striped_length(near - 0.5f * width, period, stripe)) / width;
}

// Returns in x the share of the footprint that roads cover, and in y this share minus its mean over the world.
PHYSICS_FUNCTION vec2 roads(vec2 place, vec2 footprint) {
  float x = stripes(place.x, footprint.x, kSection_m, kRoad_m);
  float y = stripes(place.y, footprint.y, kSection_m, kRoad_m);
  const float one = kRoad_m / kSection_m;
  float covered = x + y - x * y;
  return vec2(covered, covered - (2.0f * one - one * one));
}

// Returns the share of the footprint in the circle of a centre pivot, minus the share of the
// quarter section that the circle covers. The result fades to 0 as the footprint's side grows to
// three quarters of the quarter section's side.
PHYSICS_FUNCTION float pivot(vec2 place, vec2 footprint) {
  vec2 quarters = place / kQuarter_m;
  vec2 from_middle = (quarters - floor(quarters) - 0.5f) * kQuarter_m;
  float radius = max(length(from_middle), 1.0f);
  float width = max(dot(abs(from_middle), footprint) / radius, 0.01f);
  float inside = clamp((kPivotRadius_m - radius) / width + 0.5f, 0.0f, 1.0f);
  const float share = 3.14159265f * kPivotRadius_m * kPivotRadius_m / (kQuarter_m * kQuarter_m);
  return (inside - share) * clamp(1.5f - 2.0f * max(footprint.x, footprint.y) / kQuarter_m, 0.0f, 1.0f);
}

// Returns the reflectance in red, green and blue, relative to the ground's mean reflectance. The mean of all fields
// differs from the ground's mean in hue, not in luminance. `field` is a texel of the map. It holds the field's
// brightness, its dryness, and whether a centre pivot waters it, each from 0 to 1. The first two have a mean of 128 /
// 255, which leaves the reflectance unchanged. A `contrast` of 1 shows the full pattern.
PHYSICS_FUNCTION vec3 field_reflectance(vec3 field, float pivot_circle, vec2 road, float contrast) {
  vec3 brighter = vec3(0.45f, 0.40f, 0.40f);
  vec3 drier = vec3(0.26f, -0.01f, 0.22f);
  vec3 watered = -0.7f * brighter - 1.1f * drier;
  vec2 signs = (vec2(field) - 128.0f / 255.0f) * 2.0f;
  vec3 fields = brighter * signs.x + drier * signs.y + watered * (field.z * pivot_circle);
  vec3 gravel = vec3(0.35f, 0.33f, 0.30f);
  vec3 green = mix(vec3(1.0f), vec3(0.950f, 1.050f, 0.620f), contrast);  // tint of plants, relative to the ground
  return green * (vec3(1.0f) + contrast * ((1.0f - road.x) * fields + road.y * gravel));
}

// Returns the position of a place in the map of the grain, in units of its cells.
PHYSICS_FUNCTION vec2 grain_cell(vec2 place) {
  return vec2(0.891f * place.x - 0.454f * place.y, 0.454f * place.x + 0.891f * place.y) / kGrainCell_m;
}

// Returns the factor of the reflectance from the grain. `grain` is a value of the map, with a mean of 128 / 255.
PHYSICS_FUNCTION float grain_factor(float grain, float contrast) {
  return 1.0f + contrast * 0.7f * (grain - 128.0f / 255.0f);
}

const float kLine_m = 120.0f;  // width of a line on the ground

// Returns the drawn width of a line. It is at least one and a half pixels, so that lines are visible from afar.
// `across_m` is the width of a pixel on the ground.
PHYSICS_FUNCTION float line_width(float across_m) { return max(kLine_m, 1.5f * across_m); }

// Returns the share of the footprint that a line of width `line` covers. `off` is the distance of the line's middle
// from the footprint's middle.
PHYSICS_FUNCTION float line_share(float off, float width, float line) {
  float low = max(off - 0.5f * width, -0.5f * line);
  float high = min(off + 0.5f * width, 0.5f * line);
  return clamp((high - low) / width, 0.0f, 1.0f);
}

// Returns the share of the footprint that coasts and borders cover. `nearest` is a value of volume::BorderMap,
// interpolated between its texels. It holds the offset from the nearest line (x and y) and the distance to that line
// (z), both in texels, and the line's strength (w).
PHYSICS_FUNCTION float border_paint(vec4 nearest, float texel_m, vec2 footprint, float across_m) {
  vec2 offset = vec2(nearest.x, nearest.y);
  float near = length(offset);
  // For a straight line, the interpolated offset is exact. Between two lines, however, their offsets cancel each other,
  // while the distances do not. For a straight line, the distance exceeds the length of the offset by at most half a
  // texel.
  float off = min(near + 2.0f * max(nearest.z - near - 0.5f, 0.0f), max(nearest.z, near));
  // On the line itself the offset has no direction, so the mean of the footprint's width over both axes is used.
  vec2 across = near > 1e-3f ? abs(offset) / near : vec2(0.5f, 0.5f);
  float width = max(dot(across, footprint), 0.01f);
  return nearest.w * line_share(texel_m * off, width, line_width(across_m));
}

// Returns the colour of borders: yellow, which differs from crops, water, snow and rings.
PHYSICS_FUNCTION vec3 border_reflectance() { return vec3(0.85f, 0.75f, 0.08f); }

// Rings around a centre, every 10 km up to 200 km, with a line to the north and an arrowhead on each ring.
const float kRing_m = 10000.0f;
const float kLastRing_m = 200000.0f;
const float kArrow = 0.25f;  // length of an arrowhead relative to the distance between rings

// Returns the share of the footprint that rings and arrow cover. `place` is relative to the centre. `north` is the unit
// vector to true north.
PHYSICS_FUNCTION float ring_paint(vec2 place, vec2 north, vec2 footprint, float across_m) {
  float radius = max(length(place), 1.0f);
  float line = line_width(across_m);
  float width = max(dot(abs(place), footprint) / radius, 0.01f);
  float nearest = clamp(floor(radius / kRing_m + 0.5f), 1.0f, kLastRing_m / kRing_m);
  float ring = line_share(abs(radius - nearest * kRing_m), width, line);
  vec2 east = vec2(north.y, -north.x);
  float along = dot(place, north);
  float beside = abs(dot(place, east));
  float breadth = max(dot(abs(east), footprint), 0.01f);
  float northern = along > 0.0f && along < kLastRing_m ? 1.0f : 0.0f;
  float shaft = line_share(beside, breadth, line);
  float up = along / kRing_m - max(floor(along / kRing_m), 1.0f);
  float half_width = 0.09f * kRing_m * (1.0f - up / kArrow);
  float head = up > 0.0f && up < kArrow ? clamp((half_width - beside) / breadth + 0.5f, 0.0f, 1.0f) : 0.0f;
  return max(ring, northern * max(shaft, head));
}

// Returns the colour of the rings: orange, which differs from crops, water and snow.
PHYSICS_FUNCTION vec3 ring_reflectance() { return vec3(0.85f, 0.27f, 0.03f); }
