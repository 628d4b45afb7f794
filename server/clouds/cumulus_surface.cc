#include "clouds/cumulus_surface.h"

#include <algorithm>
#include <cmath>

#include "clouds/repeatable_math.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/matrix.hpp"
#include "physics/counter_random.h"

namespace thunderhead::clouds {
namespace {

using physics::CounterRandom;

// Minimum ratio of a parent's radius to its child's.
constexpr double kClearlyLarger = 1.4;
// A bubble counts as hidden if its centre is closer to another bubble's centre than this fraction
// of the other bubble's radius.
constexpr double kBuried = 0.82;
// Minimum distance between two bubbles of one parent, divided by the sum of their radii.
constexpr double kCloseness = 0.55;
// Depth of a bubble's centre below its parent's surface, divided by the bubble's radius.
constexpr double kSunken = 0.4;
// Number of random positions (darts) that are tried for each bubble that would fit.
constexpr int kDarts = 8;

glm::dvec3 NormalAt(const Bubble& bubble, const glm::dvec3& point_m) {
  const glm::dmat3 unit = UnitFromWorld(bubble);
  const glm::dvec3 normal = glm::transpose(unit) * (unit * (point_m - bubble.centre_m));
  const double length = glm::length(normal);
  return length > 0.0 ? normal / length : glm::dvec3(0.0, 0.0, 1.0);
}

// Returns the relative distance of a point from a bubble's centre: 0 at the centre, 1 on the
// surface.
double Depth(const Bubble& bubble, const glm::dvec3& point_m) {
  return glm::length(UnitFromWorld(bubble) * (point_m - bubble.centre_m));
}

glm::dvec3 HalfExtent_m(const Bubble& bubble) {
  const glm::dmat3& axes = bubble.semi_axes_m;
  glm::dvec3 half_m;
  for (int i = 0; i < 3; ++i)
    half_m[i] = glm::length(glm::dvec3(axes[0][i], axes[1][i], axes[2][i]));
  return half_m;
}

// Returns the direction that points away from the bubbles that bubble `self` touches.
glm::dvec3 AwayFromNeighbours(const std::vector<Bubble>& bubbles, std::size_t self) {
  const Bubble& bubble = bubbles[self];
  const double radius_m = RadiusOf(bubble);
  glm::dvec3 away(0.0);
  for (std::size_t i = 0; i < bubbles.size(); ++i) {
    const glm::dvec3 from_other_m = bubble.centre_m - bubbles[i].centre_m;
    const double distance_m = glm::length(from_other_m);
    if (i == self || distance_m == 0.0 || distance_m > radius_m + RadiusOf(bubbles[i])) continue;
    away += RadiusOf(bubbles[i]) / distance_m * from_other_m;
  }
  const double length = glm::length(away);
  return length > 0.0 ? away / length : glm::dvec3(0.0, 0.0, 1.0);
}

glm::dvec3 RandomDirection(CounterRandom* random) {
  const double z = 2.0 * random->Next() - 1.0;
  const double across = std::sqrt(1.0 - z * z);
  const double azimuth_deg = 360.0 * random->Next();
  return {across * CosineOfDegrees(azimuth_deg), across * SineOfDegrees(azimuth_deg), z};
}

// Returns the number of bubbles of mean size that would cover the share Sprouting::cover of a
// parent's whole surface. It only determines the number of darts.
int Wanted(const Sprouting& sprouting) {
  return static_cast<int>(sprouting.cover * 4.0 /
                          (sprouting.relative_radius * sprouting.relative_radius));
}

// Returns the maximum number of bubbles for the parent with this index if all parents together may
// get `room` bubbles. The limit is the same for each parent, so that no part of the surface is left
// bare. If there are more parents than bubbles, evenly distributed parents get one bubble each.
int ShareOf(std::int64_t index, int parents, int room) {
  if (room >= parents) return room / parents;
  return static_cast<int>((index + 1) * room / parents - index * room / parents);
}

// Places bubbles on one parent by dart throwing.
class Sprouter {
 public:
  Sprouter(const Sprouting& sprouting, std::size_t first, std::size_t parent,
           CumulusSurface* surface)
      : sprouting_(sprouting),
        parent_(parent),
        surface_(*surface),
        random_(sprouting.seed, StreamOf(first, parent)) {}

  // Adds at most `max` bubbles.
  void Run(const std::vector<std::size_t>& near, int max) {
    const Bubble parent = surface_.bubbles[parent_];
    const double radius_m = sprouting_.relative_radius * RadiusOf(parent);
    const glm::dmat3 unit = UnitFromWorld(parent);
    const int wanted = Wanted(sprouting_);
    const std::size_t siblings = surface_.bubbles.size();
    for (int dart = 0; dart < kDarts * wanted; ++dart) {
      if (static_cast<int>(surface_.bubbles.size() - siblings) >= max) return;
      const glm::dvec3 direction = RandomDirection(&random_);
      const double size = 0.65 + 0.7 * random_.Next();
      const glm::dvec3 normal = glm::normalize(glm::transpose(unit) * direction);
      if (normal.z < sprouting_.lowest_sine) continue;
      const double child_m = size * radius_m;
      const glm::dvec3 centre_m =
          parent.centre_m + parent.semi_axes_m * direction - kSunken * child_m * normal;
      if (!Shows(centre_m, near) || Crowded(centre_m, child_m, siblings)) continue;
      Bubble child = BallOf(centre_m, child_m);
      child.outward = normal;
      child.parent = static_cast<int>(parent_);
      surface_.bubbles.push_back(child);
    }
  }

 private:
  static std::uint64_t StreamOf(std::size_t first, std::size_t parent) {
    return 1000003U * static_cast<std::uint64_t>(first) + static_cast<std::uint64_t>(parent);
  }

  bool Shows(const glm::dvec3& centre_m, const std::vector<std::size_t>& near) const {
    if (surface_.base_m.has_value() && centre_m.z < *surface_.base_m) return false;
    return std::none_of(near.begin(), near.end(), [&](std::size_t other) {
      return other != parent_ && Depth(surface_.bubbles[other], centre_m) < kBuried;
    });
  }

  bool Crowded(const glm::dvec3& centre_m, double radius_m, std::size_t siblings) const {
    for (std::size_t i = siblings; i < surface_.bubbles.size(); ++i) {
      const Bubble& other = surface_.bubbles[i];
      const double min_m = kCloseness * (radius_m + RadiusOf(other));
      if (glm::distance(other.centre_m, centre_m) < min_m) return true;
    }
    return false;
  }

  const Sprouting& sprouting_;
  std::size_t parent_;
  CumulusSurface& surface_;
  CounterRandom random_;
};

}  // namespace

double RadiusOf(const Bubble& bubble) {
  return CubeRoot(std::abs(glm::determinant(bubble.semi_axes_m)));
}

glm::dmat3 UnitFromWorld(const Bubble& bubble) { return glm::inverse(bubble.semi_axes_m); }

Bubble BubbleOf(const Ellipsoid& ellipsoid) {
  Bubble bubble;
  bubble.centre_m = ellipsoid.centre_m;
  bubble.semi_axes_m = AxesOf(ellipsoid.rotation_deg);
  for (int axis = 0; axis < 3; ++axis) bubble.semi_axes_m[axis] *= ellipsoid.radii_m[axis];
  return bubble;
}

Bubble BallOf(const glm::dvec3& centre_m, double radius_m) {
  Bubble bubble;
  bubble.centre_m = centre_m;
  bubble.semi_axes_m = glm::dmat3(radius_m);
  return bubble;
}

SurfaceBox BoxOf(const CumulusSurface& surface) {
  SurfaceBox box{surface.bubbles.front().centre_m, surface.bubbles.front().centre_m};
  for (const Bubble& bubble : surface.bubbles) {
    const glm::dvec3 half_m = HalfExtent_m(bubble);
    box.low_m = glm::min(box.low_m, bubble.centre_m - half_m);
    box.high_m = glm::max(box.high_m, bubble.centre_m + half_m);
  }
  box.low_m.z = std::max(box.low_m.z, surface.base_m.value_or(box.low_m.z));
  return box;
}

void LayOnLarger(CumulusSurface* surface) {
  std::vector<Bubble>& bubbles = surface->bubbles;
  std::stable_sort(bubbles.begin(), bubbles.end(),
                   [](const Bubble& a, const Bubble& b) { return RadiusOf(a) > RadiusOf(b); });
  for (std::size_t i = 0; i < bubbles.size(); ++i) {
    Bubble& bubble = bubbles[i];
    bubble.parent = -1;
    const double radius_m = RadiusOf(bubble);
    // Bubbles are sorted by size, so the last match is the smallest bubble that is clearly larger.
    for (std::size_t j = 0; j < i; ++j) {
      const double other_m = RadiusOf(bubbles[j]);
      if (other_m < kClearlyLarger * radius_m) break;
      const double reach_m = radius_m / other_m;
      if (Depth(bubbles[j], bubble.centre_m) < 1.0 + 0.9 * reach_m) {
        bubble.parent = static_cast<int>(j);
      }
    }
    bubble.outward = bubble.parent < 0 ? AwayFromNeighbours(bubbles, i)
                                       : NormalAt(bubbles[static_cast<std::size_t>(bubble.parent)],
                                                  bubble.centre_m);
  }
}

void Sprout(const Sprouting& sprouting, std::size_t first, CumulusSurface* surface) {
  const std::size_t end = surface->bubbles.size();
  const auto sprouts = [&](std::size_t parent) {
    return RadiusOf(surface->bubbles[parent]) >= sprouting.min_radius_m;
  };
  int parents = 0;
  for (std::size_t parent = first; parent < end; ++parent) parents += sprouts(parent) ? 1 : 0;
  const int room = sprouting.max_bubbles - static_cast<int>(end);
  if (parents == 0 || room <= 0) return;
  int sprouted = 0;  // parents before the current one
  std::vector<std::size_t> near;
  for (std::size_t parent = first; parent < end; ++parent) {
    if (!sprouts(parent)) continue;
    const Bubble& bubble = surface->bubbles[parent];
    const glm::dvec3 reach_m = HalfExtent_m(bubble);
    near.clear();
    for (std::size_t other = 0; other < end; ++other) {
      const glm::dvec3 apart_m = glm::abs(surface->bubbles[other].centre_m - bubble.centre_m);
      const glm::dvec3 touch_m = reach_m + HalfExtent_m(surface->bubbles[other]);
      if (apart_m.x < touch_m.x && apart_m.y < touch_m.y && apart_m.z < touch_m.z) {
        near.push_back(other);
      }
    }
    Sprouter(sprouting, first, parent, surface)
        .Run(near, std::min(ShareOf(sprouted, parents, room), Wanted(sprouting)));
    ++sprouted;
  }
}

void FitInto(const SurfaceBox& box, CumulusSurface* surface) {
  if (surface->Empty()) return;
  const SurfaceBox from = BoxOf(*surface);
  const glm::dvec3 ratio = (box.high_m - box.low_m) / (from.high_m - from.low_m);
  const double scale = std::min({ratio.x, ratio.y, ratio.z});
  const glm::dvec3 from_floor_m((from.low_m.x + from.high_m.x) / 2.0,
                                (from.low_m.y + from.high_m.y) / 2.0, from.low_m.z);
  const glm::dvec3 to_floor_m((box.low_m.x + box.high_m.x) / 2.0,
                              (box.low_m.y + box.high_m.y) / 2.0, box.low_m.z);
  for (Bubble& bubble : surface->bubbles) {
    bubble.centre_m = to_floor_m + scale * (bubble.centre_m - from_floor_m);
    bubble.semi_axes_m *= scale;
  }
  surface->finest_m *= scale;
  if (surface->base_m.has_value()) {
    surface->base_m = to_floor_m.z + scale * (*surface->base_m - from_floor_m.z);
  }
}

}  // namespace thunderhead::clouds
