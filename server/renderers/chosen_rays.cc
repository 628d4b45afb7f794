#include "renderers/chosen_rays.h"

#include <algorithm>

#include "glm/common.hpp"
#include "shaders/bindings.h"

namespace thunderhead::renderers {
namespace {

constexpr glm::ivec2 kBlock(shaders::kPackedBlockWidth, shaders::kPackedBlockHeight);
constexpr int kBlocksInRow = shaders::kPackedBlocksInRow;
constexpr int kRowsAtATime = 64;
constexpr std::size_t kInBlock = std::size_t{kBlock.x} * kBlock.y;

}  // namespace

glm::ivec2 ChosenRays::PixelOf(std::size_t index) {
  const auto block = static_cast<int>(index / kInBlock);
  const auto within = static_cast<int>(index % kInBlock);
  return glm::ivec2(block % kBlocksInRow, block / kBlocksInRow) * kBlock +
         glm::ivec2(within % kBlock.x, within / kBlock.x);
}

void ChosenRays::Choose(const std::vector<glm::vec2>& places) {
  const std::size_t in_row = kInBlock * kBlocksInRow;
  const auto rows = static_cast<int>((places.size() + in_row - 1) / in_row) * kBlock.y;
  const int width = kBlocksInRow * kBlock.x;
  rect_ = {glm::ivec2(0), glm::ivec2(width, rows)};
  const int wanted = std::max((rows + kRowsAtATime - 1) / kRowsAtATime, 1) * kRowsAtATime;
  if (places_.Size().y < wanted) places_ = gl::Texture2D(GL_RG32F, {width, wanted});
  // The last place is repeated in the unused pixels of the last row of blocks.
  texels_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(rows),
                 places.empty() ? glm::vec2(0.0F) : places.back());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const glm::ivec2 pixel = PixelOf(i);
    texels_[static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(width) +
            static_cast<std::size_t>(pixel.x)] = places[i];
  }
  places_.UploadRows(rows, GL_RG, GL_FLOAT, texels_.data());
}

void ChosenRays::ChooseAll(const glm::ivec2& size_px) {
  const glm::ivec2 blocks = (size_px + kBlock - 1) / kBlock;
  std::vector<glm::vec2> places;
  places.reserve(kInBlock * static_cast<std::size_t>(blocks.x) *
                 static_cast<std::size_t>(blocks.y));
  for (int block = 0; block < blocks.x * blocks.y; ++block) {
    const glm::ivec2 first = glm::ivec2(block % blocks.x, block / blocks.x) * kBlock;
    for (int within = 0; within < static_cast<int>(kInBlock); ++within) {
      const glm::ivec2 pixel = first + glm::ivec2(within % kBlock.x, within / kBlock.x);
      const glm::vec2 middle = glm::vec2(glm::min(pixel, size_px - 1)) + 0.5F;
      places.push_back(2.0F * middle / glm::vec2(size_px) - 1.0F);
    }
  }
  Choose(places);
}

void ChosenRays::Bind() const { places_.Bind(shaders::kChosenPlacesUnit); }

}  // namespace thunderhead::renderers
