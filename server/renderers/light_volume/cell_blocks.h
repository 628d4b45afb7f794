// Runs a compute shader on the blocks of cells that a ray may meet. The shader's side is
// shaders/light_volume/cell_blocks.glsl.
#pragma once

#include "absl/status/status.h"
#include "gl/program.h"
#include "renderers/medium.h"

namespace thunderhead::renderers {

// Runs `program` with one work group for each block of `medium` with an index from `first` to `end`
// - 1. The program's other inputs must be bound.
absl::Status ForCellBlocks(gl::Pieces& pieces, const gl::PieceCost& block,
                           const ResidentMedium& medium, const gl::Program& program, int first,
                           int end);

}  // namespace thunderhead::renderers
