#include "renderers/light_volume/cell_blocks.h"

#include <algorithm>

#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

constexpr int kMaxGroupsInRow = 65535;  // what OpenGL 4.5 guarantees along each axis

}  // namespace

absl::Status ForCellBlocks(gl::Pieces& pieces, const gl::PieceCost& block,
                           const ResidentMedium& medium, const gl::Program& program) {
  medium.BindBlocks(program);
  program.Set(uniform::cell_count, medium.Bounds().grid.cells);
  program.Use();
  return pieces.Steps(block, medium.BlockCount(), [&](int begin, int end) {
    const int count = end - begin;
    const int rows = (count + kMaxGroupsInRow - 1) / kMaxGroupsInRow;
    program.Set(uniform::first_block, begin);
    program.Set(uniform::end_block, end);
    glDispatchCompute(static_cast<GLuint>(std::min(count, kMaxGroupsInRow)),
                      static_cast<GLuint>(rows), 1);
  });
}

}  // namespace thunderhead::renderers
