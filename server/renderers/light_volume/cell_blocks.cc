#include "renderers/light_volume/cell_blocks.h"

#include <algorithm>

#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

// Minimum that OpenGL 4.5 guarantees for the number of work groups along each axis.
constexpr int kMaxGroupsInRow = 65535;

}  // namespace

absl::Status ForCellBlocks(gl::Pieces& pieces, const gl::PieceCost& block,
                           const ResidentMedium& medium, const gl::Program& program, int first,
                           int end) {
  medium.BindBlocks(program);
  program.Set(uniform::cell_count, medium.Bounds().grid.cells);
  program.Use();
  return pieces.Steps(block, end - first, [&](int from, int to) {
    const int count = to - from;
    const int rows = (count + kMaxGroupsInRow - 1) / kMaxGroupsInRow;
    program.Set(uniform::first_block, first + from);
    program.Set(uniform::end_block, first + to);
    glDispatchCompute(static_cast<GLuint>(std::min(count, kMaxGroupsInRow)),
                      static_cast<GLuint>(rows), 1);
  });
}

}  // namespace thunderhead::renderers
