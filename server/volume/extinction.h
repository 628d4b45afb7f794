// Converts mixing ratios to extinction. The fields of a storm are added up into a few channels of
// extinction over the smallest box with all cells that matter. The result is half floats ready for
// a texture. This code does not depend on scenes or GL.
//
// The extinction of field f is its mass extinction 3 / (2 rho_f R_f) times its concentration
// rho_air q_f: Riley et al. 2003 (AMS), eq. 4.
#pragma once

#include <cstdint>
#include <vector>

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// One field's contribution to the volume.
struct ExtinctionTerm {
  int field = 0;  // index into HydrometeorFields::fields
  float mass_extinction_m2_per_kg = 0.0F;
  int channel = 0;
  bool by_cell = false;  // the same as in MassExtinction
};

inline constexpr int kMaxChannels = 8;

// Up to four interleaved channels of the volume.
struct ExtinctionPlane {
  int channels = 0;                   // 1, 2 or 4
  std::vector<std::uint16_t> texels;  // IEEE half floats, channel fastest, then x, y, z
};

// Extinction over a box of cells. A cell's value is at its centre. Between centres the extinction
// is linear, and outside the stored cells it is that of the nearest cell. Each field's total is
// kept: inside the domain the box has a border of empty cells, and at the domain's faces the last
// cell extends to the face.
struct ExtinctionVolume {
  RegularGrid grid;       // the stored cells; no cells if nothing is worth drawing
  glm::dvec3 low_m{0.0};  // the box outside of which extinction is zero
  glm::dvec3 high_m{0.0};
  std::vector<ExtinctionPlane> planes;  // channels 0-3, then 4-7
  float extinction_per_m = 0.0F;        // the extinction of texel value 1; a power of two
  float maximum_per_m = 0.0F;           // largest sum over all channels in a cell
  float negligible_per_m = 0.0F;        // NegligibleExtinction_per_m for maximum_per_m

  bool Empty() const { return grid.CellCount() == 0; }
  int Channels() const;  // sum over all planes, including padding channels
};

// A cell is left out if its extinction, along the domain's diagonal, adds up to less than this
// optical depth. If the thickest cell's adds up to less than 1, a cell is left out below this share
// of the thickest cell's extinction. A thin medium is therefore drawn like a thick one. It is
// faint, but it is all there is to see.
inline constexpr double kNegligibleOpticalDepth = 1e-3;

// A medium whose thickest cell adds up to less is left out completely. No image would show it, and
// ray marching would soon underflow.
inline constexpr double kFaintestOpticalDepth = 1e-9;

// Returns the extinction up to which a cell of `grid` is left out, if the thickest cell's is
// `maximum_per_m`.
float NegligibleExtinction_per_m(const RegularGrid& grid, float maximum_per_m);

// Adds up `terms`, which use channels 0 to `channels` - 1.
ExtinctionVolume ComputeExtinction(const HydrometeorFields& fields,
                                   const std::vector<ExtinctionTerm>& terms, int channels);

}  // namespace thunderhead::volume
