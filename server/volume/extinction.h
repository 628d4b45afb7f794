// Converts mixing ratios to extinction. The fields of a storm are added up into a few channels of
// extinction. The volume covers the smallest box that contains all cells above a threshold. Its
// values are half floats, ready for a texture. This code does not depend on scenes or GL.
//
// The extinction of field f is its mass extinction 3 / (2 rho_f R_f) times its concentration
// rho_air q_f: Riley et al. 2003 (AMS), eq. 4.
#pragma once

#include <cstdint>
#include <vector>

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// The contribution of one field to the volume.
struct ExtinctionTerm {
  int field = 0;  // index into HydrometeorFields::fields
  float mass_extinction_m2_per_kg = 0.0F;
  int channel = 0;
  bool by_cell = false;  // see MassExtinction::by_cell
};

inline constexpr int kMaxChannels = 8;

// Up to four interleaved channels of the volume.
struct ExtinctionPlane {
  int channels = 0;                   // 1, 2 or 4
  std::vector<std::uint16_t> texels;  // IEEE half floats, channel fastest, then x, y, z
};

// Extinction over a box of cells. A cell's value is at its centre. Between centres the extinction
// is linear, and outside the stored cells it is that of the nearest cell. Interpolation keeps each
// field's total. For this purpose the box has a border of empty cells inside the domain, and at the
// domain's faces the last cell's value extends to the face.
struct ExtinctionVolume {
  RegularGrid grid;       // the stored cells; the grid has no cells if the medium is too faint to
                          // draw
  glm::dvec3 low_m{0.0};  // low corner of the box outside of which extinction is zero
  glm::dvec3 high_m{0.0};
  std::vector<ExtinctionPlane> planes;  // channels 0-3, then 4-7
  float extinction_per_m = 0.0F;        // the extinction that the texel value 1 stands for; a power
                                        // of two
  float maximum_per_m = 0.0F;           // largest extinction of a cell, all channels together
  float negligible_per_m = 0.0F;        // NegligibleExtinction_per_m for maximum_per_m

  bool Empty() const { return grid.CellCount() == 0; }
  int Channels() const;  // number of channels of all planes, including padding channels
};

// The threshold for leaving out a cell. A cell is left out if its extinction times the length of
// the domain's diagonal is below this optical depth. In a thin medium, whose largest extinction
// times that length is below 1, a cell is left out below this share of the largest extinction. Thin
// media are therefore drawn completely.
inline constexpr double kNegligibleOpticalDepth = 1e-3;

// The optical depth below which a whole medium is left out: its largest extinction times the length
// of the domain's diagonal. No image would show such a medium, and ray marching would underflow.
inline constexpr double kFaintestOpticalDepth = 1e-9;

// Returns the extinction up to which a cell of `grid` is left out. `maximum_per_m` is the largest
// extinction of a cell.
float NegligibleExtinction_per_m(const RegularGrid& grid, float maximum_per_m);

// Computes the extinction volume from the contributions `terms`, which use channels 0 to `channels`
// - 1.
ExtinctionVolume ComputeExtinction(const HydrometeorFields& fields,
                                   const std::vector<ExtinctionTerm>& terms, int channels);

}  // namespace thunderhead::volume
