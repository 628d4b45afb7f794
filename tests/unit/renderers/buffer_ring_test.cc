#include "renderers/half_angle/buffer_ring.h"

#include <random>
#include <vector>

#include "gtest/gtest.h"

namespace thunderhead::renderers {
namespace {

constexpr int kSide = 12;

// A simulated picture. Each pixel holds the number of the last state that changed it.
using Picture = std::vector<int>;

void Copy(const Picture& from, const PixelRect& rect, Picture* to) {
  for (int y = rect.low.y; y < rect.high.y; ++y) {
    for (int x = rect.low.x; x < rect.high.x; ++x) {
      const auto i = static_cast<std::size_t>(y * kSide + x);
      (*to)[i] = from[i];
    }
  }
}

TEST(BufferRing, EachBufferHoldsItsStateWhole) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> place(0, kSide);
  for (const std::size_t count : {1U, 2U, 5U}) {
    BufferRing ring(count);
    Picture expected(kSide * kSide, 0);
    std::vector<Picture> buffers(count, expected);
    int written = 0;
    for (int state = 1; state <= 60; ++state) {
      const auto index = static_cast<std::size_t>(state);
      PixelRect changed{{place(random), place(random)}, {place(random), place(random)}};
      if (changed.Empty()) changed = {};
      Copy(Picture(kSide * kSide, state), changed, &expected);
      const PixelRect rect = ring.Write(index, changed);
      Copy(expected, rect, &buffers[ring.Of(index)]);
      EXPECT_EQ(buffers[ring.Of(index)], expected) << count << " buffers, state " << state;
      written += rect.Empty() ? 0 : (rect.high.x - rect.low.x) * (rect.high.y - rect.low.y);
    }
    EXPECT_LT(written, 60 * kSide * kSide) << "some of it was left as it was";
  }
}

TEST(BufferRing, NothingIsWrittenBeforeAnythingChanges) {
  BufferRing ring(3);
  EXPECT_TRUE(ring.Write(1, {}).Empty());
  const PixelRect changed{{1, 2}, {3, 4}};
  EXPECT_EQ(ring.Write(2, changed), changed);
  EXPECT_EQ(ring.Write(3, {}), changed);
  EXPECT_EQ(ring.Write(4, {}), changed);
  EXPECT_TRUE(ring.Write(5, {}).Empty());
}

}  // namespace
}  // namespace thunderhead::renderers
