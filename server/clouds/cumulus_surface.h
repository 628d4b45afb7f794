// The surface of a cumulus cloud as ellipsoids (bubbles) on larger ellipsoids, at several scales
// (F. Neyret 2000, "A Phenomenological Shader for the Rendering of Cumulus Clouds", 4.3, figure 4
// right). This code does not depend on storms, shading or GL.
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
  glm::dmat3 semi_axes_m{1.0};        // the columns are the semi-axes
  glm::dvec3 outward{0.0, 0.0, 1.0};  // N_sh in the paper: normal of the parent at this bubble; 0
                                      // if undefined
  int parent = -1;  // index of the larger bubble on which this bubble is; -1 if there is none
};

// Returns the radius of a ball with the same volume as the bubble.
double RadiusOf(const Bubble& bubble);
// Returns the linear map of offsets from the bubble's centre that turns the bubble into the unit
// ball.
glm::dmat3 UnitFromWorld(const Bubble& bubble);
Bubble BubbleOf(const Ellipsoid& ellipsoid);
Bubble BallOf(const glm::dvec3& centre_m, double radius_m);

struct CumulusSurface {
  std::vector<Bubble> bubbles;   // parents come before their children
  std::optional<double> base_m;  // height of the flat base; everything below is cut off
  double finest_m = 0.0;         // radius of the finest bubbles

  bool Empty() const { return bubbles.empty(); }
};

struct SurfaceBox {
  glm::dvec3 low_m{0.0};
  glm::dvec3 high_m{0.0};
};

// Returns the axis-aligned bounding box of the part above the base. The surface must not be empty.
SurfaceBox BoxOf(const CumulusSurface& surface);

// Sorts bubbles by size, largest first, and sets every bubble's parent and outward direction. The
// parent is the smallest clearly larger bubble that the bubble touches. The outward direction is
// the parent's normal. For a bubble without a parent, it points away from the bubbles that this
// bubble touches.
void LayOnLarger(CumulusSurface* surface);

// Parameters of the bubbles that grow on existing bubbles.
struct Sprouting {
  double relative_radius = 0.34;  // radius of a new bubble divided by its parent's radius; varied
                                  // by up to a third
  double cover = 0.8;             // share of the parent's surface that its bubbles would cover
  double lowest_sine = -0.6;      // the smallest sine of the normal's elevation angle at which
                                  // bubbles grow
  double min_radius_m = 0.0;      // parents that are smaller than this get no bubbles
  int max_bubbles = 20000;  // maximum number of bubbles after growth; close to it, each parent
                            // gets fewer, or only some get one
  std::uint64_t seed = 1;
};

// Grows new bubbles on the existing bubbles from index `first` on, except where other bubbles or
// the base would hide them. The parents of the existing bubbles must be set (LayOnLarger). The
// result for a seed has the same bits on every machine.
void Sprout(const Sprouting& sprouting, std::size_t first, CumulusSurface* surface);

// Moves and uniformly scales the surface so that it fits into `box` and stands on the box's floor.
void FitInto(const SurfaceBox& box, CumulusSurface* surface);

}  // namespace thunderhead::clouds
