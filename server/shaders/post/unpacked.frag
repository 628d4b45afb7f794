// Copies the pixels of a packed picture (renderers::ChosenRays::ChooseAll) to their places in the picture.
#include "common/bindings.glsl"

layout(binding = kPackedUnit) uniform sampler2D packed_rays;

uniform ivec2 picture_size;

out vec4 radiance;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  const ivec2 kBlock = ivec2(kPackedBlockWidth, kPackedBlockHeight);
  ivec2 place = pixel / kBlock;
  int block = place.y * ((picture_size.x - 1) / kBlock.x + 1) + place.x;
  ivec2 packed_place = ivec2(block % kPackedBlocksInRow, block / kPackedBlocksInRow);
  radiance = texelFetch(packed_rays, packed_place * kBlock + pixel % kBlock, 0);
}
