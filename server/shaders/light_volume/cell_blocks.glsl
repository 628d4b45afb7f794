// Blocks of cells that a ray may meet (volume::CellBlocks). Each work group of kBlockGroupSize invocations processes
// one block.
#include "common/bindings.glsl"
#include "light_volume/bindings.glsl"

layout(local_size_x = kBlockGroupSize) in;
layout(std430, binding = kBlocksBinding) readonly buffer Blocks { uint blocks[]; };

uniform ivec3 cell_count;
uniform ivec3 cells_per_block;
uniform int first_block;  // first block of this dispatch
uniform int end_block;

const uint kThickBlock = 1u << 31;

struct Block {
  bool listed;  // false for surplus work groups in the last row of the dispatch
  bool thick;
  ivec3 first_cell;
  int cells;
  float per_row;  // reciprocal of the number of cells in a row; per_layer is that of the number in a layer
  float per_layer;
};

Block block_of_group() {
  uint at = uint(first_block) + gl_WorkGroupID.x + gl_NumWorkGroups.x * gl_WorkGroupID.y;
  ivec3 size = cells_per_block;
  float per_row = 1.0 / float(size.x);
  Block block = Block(at < uint(end_block), false, ivec3(0), size.x * size.y * size.z, per_row, per_row / float(size.y));
  if (!block.listed) return block;
  uint packed_block = blocks[at];
  ivec3 place = ivec3(packed_block & 1023u, packed_block >> 10 & 1023u, packed_block >> 20 & 1023u);
  block.thick = (packed_block & kThickBlock) != 0u;
  block.first_cell = place * size;
  return block;
}

// Returns the position of cell `i` of a block relative to the block's first cell. It avoids integer division, because
// software GL does not vectorize it.
ivec3 cell_within(Block block, int i) {
  int row = int((float(i) + 0.5) * block.per_row);
  int layer = int((float(i) + 0.5) * block.per_layer);
  return ivec3(i - row * cells_per_block.x, row - layer * cells_per_block.y, layer);
}
