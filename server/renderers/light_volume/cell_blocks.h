// Work on the blocks of cells that a ray may meet, as shaders/light_volume/cell_blocks.glsl does
// it.
#pragma once

#include "absl/status/status.h"
#include "gl/program.h"
#include "renderers/medium.h"

namespace thunderhead::renderers {

// Runs `program`, whose other inputs are bound, with a work group for each block of `medium` from
// `first` to before `end`.
absl::Status ForCellBlocks(gl::Pieces& pieces, const gl::PieceCost& block,
                           const ResidentMedium& medium, const gl::Program& program, int first,
                           int end);

}  // namespace thunderhead::renderers
