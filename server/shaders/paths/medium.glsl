// The medium of the path-traced reference (reference/medium.h), with open sides and linear interpolation. Rays pass
// through it from brick to brick (reference/brick_walk.h, reference/tracking.h). Places are in units of bricks from the
// first brick's lower corner, directions are unit vectors, distances are in metres. The argument `similar` selects the
// exact medium (false) or the similar medium (true), see decision 56.
#include "paths/bindings.glsl"
#include "paths/random.glsl"
#include "paths/roulette.glsl"

// Extinction of cells in 1/m; x exact medium, y similar medium.
layout(binding = kPathExtinctionUnit) uniform sampler3D extinctions;
// Upper bounds of extinction by brick in 1/m; x exact medium, y similar medium.
layout(binding = kPathMajorantUnit) uniform sampler3D majorants;
uniform ivec3 cell_count;
uniform ivec3 brick_count;
uniform ivec3 first_cell;  // first cell of the first brick
uniform vec3 box_low;  // corners of the medium's box, in units of bricks
uniform vec3 box_high;
uniform vec3 bricks_per_m;

float of_optics(vec2 value, bool similar) { return similar ? value.y : value.x; }

float cell_extinction(ivec3 cell, bool similar) {
  return of_optics(texelFetch(extinctions, clamp(cell, ivec3(0), cell_count - 1), 0).xy, similar);
}

// The extinction in a brick, which is one trilinear function. The struct holds its values at the four edges parallel to
// x, and their slopes along x.
struct Edges {
  vec4 low;
  vec4 slope;
};

Edges edges_of(ivec3 brick, bool similar) {
  ivec3 at = first_cell + brick;
  vec4 low = vec4(cell_extinction(at, similar), cell_extinction(at + ivec3(0, 1, 0), similar),
                  cell_extinction(at + ivec3(0, 0, 1), similar), cell_extinction(at + ivec3(0, 1, 1), similar));
  vec4 high = vec4(cell_extinction(at + ivec3(1, 0, 0), similar), cell_extinction(at + ivec3(1, 1, 0), similar),
                   cell_extinction(at + ivec3(1, 0, 1), similar), cell_extinction(at + ivec3(1, 1, 1), similar));
  return Edges(low, high - low);
}

// Returns the extinction at a place in the brick. `share` is the place relative to the brick's lower corner, from 0 to
// 1.
float extinction_in(Edges edges, vec3 share) {
  vec4 along_x = edges.low + share.x * edges.slope;
  vec2 along_y = along_x.xz + share.y * (along_x.yw - along_x.xz);
  return along_y.x + share.z * (along_y.y - along_y.x);
}

struct Walk {
  vec3 from;  // place where the ray enters the box
  vec3 per_m;  // change of the place, in bricks, per metre along the ray
  vec3 m_per;
  ivec3 stride;
  ivec3 brick;
  vec3 faces_m;  // distances to the faces of the brick through which the ray can leave
  float before_m;  // distance from the ray's origin to the box
  float at_m;  // distance travelled inside the box
  float leaves_m;  // distance at which the ray leaves the brick
  float end_m;
};

void find_faces(inout Walk walk) {
  walk.faces_m = (vec3(walk.brick + max(walk.stride, ivec3(0))) - walk.from) * walk.m_per;
  walk.leaves_m = clamp(min(walk.faces_m.x, min(walk.faces_m.y, walk.faces_m.z)), walk.at_m, walk.end_m);
}

Walk begin_walk(vec3 place, vec3 direction, float limit_m) {
  Walk walk;
  walk.per_m = direction * bricks_per_m;
  // The minimum avoids a division by zero. A ray parallel to an axis never reaches the faces parallel to it.
  walk.per_m = mix(walk.per_m, vec3(1e-15), lessThan(abs(walk.per_m), vec3(1e-15)));
  walk.m_per = 1.0 / walk.per_m;
  vec3 to_low = (box_low - place) * walk.m_per;
  vec3 to_high = (box_high - place) * walk.m_per;
  vec3 nearer = min(to_low, to_high);
  vec3 farther = max(to_low, to_high);
  walk.before_m = max(max(nearer.x, nearer.y), max(nearer.z, 0.0));
  walk.at_m = 0.0;
  walk.end_m = min(min(farther.x, farther.y), min(farther.z, limit_m)) - walk.before_m;
  walk.from = place + walk.before_m * walk.per_m;
  walk.stride = ivec3(sign(walk.per_m));
  walk.brick = clamp(ivec3(floor(walk.from)), ivec3(0), brick_count - 1);
  find_faces(walk);
  return walk;
}

bool goes_on(Walk walk) {
  return walk.at_m < walk.end_m && all(greaterThanEqual(walk.brick, ivec3(0))) && all(lessThan(walk.brick, brick_count));
}

void next_brick(inout Walk walk) {
  walk.at_m = walk.leaves_m;
  if (walk.faces_m.x <= walk.faces_m.y && walk.faces_m.x <= walk.faces_m.z) {
    walk.brick.x += walk.stride.x;
  } else if (walk.faces_m.y <= walk.faces_m.z) {
    walk.brick.y += walk.stride.y;
  } else {
    walk.brick.z += walk.stride.z;
  }
  find_faces(walk);
}

float majorant_of(ivec3 brick, bool similar) { return of_optics(texelFetch(majorants, brick, 0).xy, similar); }

// Returns the distance to the first collision with a particle. Returns -1 if there is no collision within `limit_m`. It
// uses null collisions (Woodcock et al. 1965).
float distance_to_collision(vec3 place, vec3 direction, float limit_m, bool similar) {
  Walk walk = begin_walk(place, direction, limit_m);
  float depth = random_exponential();  // remaining optical depth, by the majorant, to the next possible collision
  while (goes_on(walk)) {
    float majorant = majorant_of(walk.brick, similar);
    float at_m = walk.at_m;
    while (depth < (walk.leaves_m - at_m) * majorant) {
      at_m += depth / majorant;
      vec3 share = walk.from + at_m * walk.per_m - vec3(walk.brick);
      if (random_uniform() * majorant < extinction_in(edges_of(walk.brick, similar), clamp(share, 0.0, 1.0))) {
        return walk.before_m + at_m;
      }
      depth = random_exponential();
    }
    depth -= (walk.leaves_m - at_m) * majorant;
    next_brick(walk);
  }
  return -1.0;
}

// Returns an unbiased estimate of the transmittance to infinity, which is exact unless it is small. In a brick,
// extinction is cubic along the ray, so Simpson's rule is exact.
float transmittance_to_infinity(vec3 place, vec3 direction, bool similar) {
  Walk walk = begin_walk(place, direction, kEndlessPath_m);
  float end_depth = kRouletteDepth + random_exponential();
  float depth = 0.0;
  while (goes_on(walk)) {
    if (majorant_of(walk.brick, similar) > 0.0) {
      Edges edges = edges_of(walk.brick, similar);
      vec3 first = clamp(walk.from + walk.at_m * walk.per_m - vec3(walk.brick), 0.0, 1.0);
      vec3 last = clamp(walk.from + walk.leaves_m * walk.per_m - vec3(walk.brick), 0.0, 1.0);
      float sum = extinction_in(edges, first) + 4.0 * extinction_in(edges, 0.5 * (first + last)) + extinction_in(edges, last);
      depth += (walk.leaves_m - walk.at_m) * sum / 6.0;
      if (depth > end_depth) return 0.0;
    }
    next_brick(walk);
  }
  return exp(-min(depth, kRouletteDepth));
}
