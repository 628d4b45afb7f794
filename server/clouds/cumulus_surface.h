// A cumulus as a surface: ellipsoids that lie on ellipsoids, scale upon scale (F. Neyret 2000, "A
// Phenomenological Shader for the Rendering of Cumulus Clouds", 4.3, figure 4 right). Knows no
// storm, no shading and no GL.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "clouds/cloud_shape.h"
#include "glm/mat3x3.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::clouds {

// One ellipsoid of the surface.
struct Bubble {
  glm::dvec3 centre_m{0.0};
  glm::dmat3 semi_axes_m{1.0};        // columns
  glm::dvec3 outward{0.0, 0.0, 1.0};  // N_sh: normal of what it lies on; 0 if it stands alone
  int parent = -1;                    // the bubble that it lies on, earlier in the list; or none
};

// The radius of a ball of the same volume.
double RadiusOf(const Bubble& bubble);
// From the world to where the bubble is the unit ball around the origin.
glm::dmat3 UnitFromWorld(const Bubble& bubble);
Bubble BubbleOf(const Ellipsoid& ellipsoid);
Bubble BallOf(const glm::dvec3& centre_m, double radius_m);

struct CumulusSurface {
  std::vector<Bubble> bubbles;   // parents before those that lie on them
  std::optional<double> base_m;  // what is lower is cut away
  double finest_m = 0.0;         // radius of the finest bubbles

  bool Empty() const { return bubbles.empty(); }
};

struct SurfaceBox {
  glm::dvec3 low_m{0.0};
  glm::dvec3 high_m{0.0};
};

// The smallest level box that holds what is above the base. Not of an empty surface.
SurfaceBox BoxOf(const CumulusSurface& surface);

// Gives every bubble the smallest of the clearly larger ones that it touches as parent, and an
// outward direction: the parent's normal, or, without a parent, away from the bubbles that it
// touches. Larger bubbles come first afterwards.
void LayOnLarger(CumulusSurface* surface);

// How bubbles sprout from those that are there.
struct Sprouting {
  double relative_radius =
      0.34;                   // of a bubble over that of its parent; each differs by up to a third
  double cover = 0.8;         // of the parent's upper side
  double lowest_sine = -0.6;  // of the normal: below it nothing sprouts
  double least_radius_m = 0.0;  // of parents whose bubbles are worth drawing
  int most_bubbles = 20000;     // in the surface; near it each parent has fewer
  std::uint64_t seed = 1;
};

// Adds bubbles all over those from `first` on that show; parents must be set. The same on every
// machine for a seed.
void Sprout(const Sprouting& sprouting, std::size_t first, CumulusSurface* surface);

// Moves and scales the surface evenly so that it fits into a box, standing on its floor.
void FitInto(const SurfaceBox& box, CumulusSurface* surface);

}  // namespace thunderhead::clouds
