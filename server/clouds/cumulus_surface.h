// A cumulus as a surface: ellipsoids on ellipsoids at several scales (F. Neyret 2000, "A
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
  glm::dvec3 outward{0.0, 0.0, 1.0};  // N_sh: normal of its parent where it sits; 0 if it has none
  int parent = -1;  // index of the bubble that it sits on, which comes earlier; -1: none
};

// The radius of a ball of the same volume.
double RadiusOf(const Bubble& bubble);
// Transforms world coordinates so that the bubble becomes the unit ball around the origin.
glm::dmat3 UnitFromWorld(const Bubble& bubble);
Bubble BubbleOf(const Ellipsoid& ellipsoid);
Bubble BallOf(const glm::dvec3& centre_m, double radius_m);

struct CumulusSurface {
  std::vector<Bubble> bubbles;   // parents come before their children
  std::optional<double> base_m;  // everything below is cut off
  double finest_m = 0.0;         // radius of the finest bubbles

  bool Empty() const { return bubbles.empty(); }
};

struct SurfaceBox {
  glm::dvec3 low_m{0.0};
  glm::dvec3 high_m{0.0};
};

// The axis-aligned bounding box of the part above the base. The surface must not be empty.
SurfaceBox BoxOf(const CumulusSurface& surface);

// Sets every bubble's parent, the smallest clearly larger bubble that it touches, and outward
// direction: the parent's normal or, without a parent, away from the bubbles that it touches. Sorts
// bubbles by size, largest first.
void LayOnLarger(CumulusSurface* surface);

// Parameters of the bubbles that grow on existing ones.
struct Sprouting {
  double relative_radius = 0.34;  // of a bubble's radius to its parent's; varied by up to a third
  double cover = 0.8;             // share of the parent's upper side that bubbles cover
  double lowest_sine = -0.6;      // of the normal's elevation; nothing grows below it
  double min_radius_m = 0.0;      // smaller parents get no bubbles
  int max_bubbles = 20000;  // in the surface; when it is nearly reached, each parent gets fewer
  std::uint64_t seed = 1;
};

// Grows bubbles on all visible bubbles from index `first` on; parents must be set. The same bits on
// every machine for a seed.
void Sprout(const Sprouting& sprouting, std::size_t first, CumulusSurface* surface);

// Moves and uniformly scales the surface to fit a box, standing on its floor.
void FitInto(const SurfaceBox& box, CumulusSurface* surface);

}  // namespace thunderhead::clouds
