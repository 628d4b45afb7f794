// Blocks of cells that a ray may meet (volume::CellBlocks), one a work group of kBlockGroupSize invocations.
#include "common/bindings.glsl"
#include "light_volume/bindings.glsl"

layout(local_size_x = kBlockGroupSize) in;
layout(std430, binding = kBlocksBinding) readonly buffer Blocks { uint blocks[]; };

uniform ivec3 cell_count;
uniform ivec3 cells_per_block;
uniform int first_block;  // of those that are worked on now
uniform int end_block;

const uint kThickBlock = 1u << 31;

struct Block {
  bool listed;  // groups in rows may be more than blocks
  bool thick;
  ivec3 first_cell;
};

Block block_of_group() {
  uint at = uint(first_block) + gl_WorkGroupID.x + gl_NumWorkGroups.x * gl_WorkGroupID.y;
  if (at >= uint(end_block)) return Block(false, false, ivec3(0));
  uint packed_block = blocks[at];
  ivec3 place = ivec3(packed_block & 1023u, packed_block >> 10 & 1023u, packed_block >> 20 & 1023u);
  return Block(true, (packed_block & kThickBlock) != 0u, place * cells_per_block);
}

int cells_in_block() { return cells_per_block.x * cells_per_block.y * cells_per_block.z; }

// Cell `i` of a block, from its first; `per_row` and `per_layer` are the reciprocals of the numbers of cells in each. Not by
// integers: software divides those one by one.
ivec3 cell_within(int i, float per_row, float per_layer) {
  int row = int((float(i) + 0.5) * per_row);
  int layer = int((float(i) + 0.5) * per_layer);
  return ivec3(i - row * cells_per_block.x, row - layer * cells_per_block.y, layer);
}
