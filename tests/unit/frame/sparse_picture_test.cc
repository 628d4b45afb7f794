// Tests of pictures that are completed from coarser pictures. A function gives the colour at each
// place.
#include "frame/sparse_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>

#include "gtest/gtest.h"

namespace thunderhead::frame {
namespace {

constexpr int kContrast = 12;

// A grey picture that can be evaluated at any place, as frame::DrawPlaces requires.
struct Canvas {
  std::function<double(glm::vec2)> grey;  // 0 to 1
  glm::ivec2 size_px;
  std::size_t drawn = 0;

  std::vector<std::uint16_t> At(const std::vector<glm::vec2>& places) const {
    std::vector<std::uint16_t> colors;
    for (const glm::vec2& place : places) {
      const auto value = static_cast<std::uint16_t>(std::lround(65535.0 * grey(place)));
      colors.insert(colors.end(), {value, value, value});
    }
    return colors;
  }

  static std::vector<glm::vec2> PixelsOf(const glm::ivec2& size_px) {
    std::vector<glm::vec2> places;
    for (int y = 0; y < size_px.y; ++y) {
      for (int x = 0; x < size_px.x; ++x) {
        const glm::vec2 place = 2.0F * glm::vec2(x + 0.5F, y + 0.5F) / glm::vec2(size_px) - 1.0F;
        places.emplace_back(place.x, -place.y);
      }
    }
    return places;
  }

  std::vector<std::uint8_t> Complete(int contrast) {
    const glm::ivec2 coarsest_px = CoarsestOf(size_px);
    auto whole = CompletePicture({coarsest_px.x, coarsest_px.y, At(PixelsOf(coarsest_px))}, size_px,
                                 contrast, [&](const std::vector<glm::vec2>& places) {
                                   drawn += places.size();
                                   return At(places);
                                 });
    EXPECT_TRUE(whole.ok()) << whole.status();
    return Dithered(*whole);
  }

  // Returns the largest deviation of the picture from the canvas, in 8-bit levels (0 to 255).
  // Pixels less than `margin_px` from the edges are left out.
  double WorstOf(const std::vector<std::uint8_t>& rgb, int margin_px) const {
    const std::vector<std::uint16_t> exact = At(PixelsOf(size_px));
    double worst = 0.0;
    for (int y = margin_px; y < size_px.y - margin_px; ++y) {
      for (int x = margin_px; x < size_px.x - margin_px; ++x) {
        const auto at = static_cast<std::size_t>(3 * (y * size_px.x + x));
        worst = std::max(worst, std::abs(rgb[at] - exact[at] / 257.0));
      }
    }
    return worst;
  }
};

TEST(SparsePicture, FollowsASlopeWithoutAnyRays) {
  for (const glm::ivec2& size_px : {glm::ivec2(64, 48), glm::ivec2(61, 43), glm::ivec2(7, 5)}) {
    Canvas canvas{[](glm::vec2 place) { return 0.5 + 0.2 * place.x - 0.25 * place.y; }, size_px};
    const auto rgb = canvas.Complete(1000);
    EXPECT_EQ(canvas.drawn, 0U);
    EXPECT_EQ(rgb.size(), static_cast<std::size_t>(3 * size_px.x * size_px.y));
    // The noise is up to half a step, and so is the rounding after it.
    EXPECT_LE(canvas.WorstOf(rgb, 4), 1.05) << size_px.x;
  }
}

// Linear interpolation between pixels would be off by 3.5 steps.
TEST(SparsePicture, FollowsACurveByItsNeighbours) {
  Canvas canvas{[](glm::vec2 place) { return 0.5 + 0.4 * std::tanh(10.0 * place.x); }, {128, 96}};
  const auto rgb = canvas.Complete(1000);
  EXPECT_EQ(canvas.drawn, 0U);
  EXPECT_LE(canvas.WorstOf(rgb, 0), 2.0);
}

// A contrast between pixels of the quarter-size picture requires new rays. The same contrast
// between pixels of the half-size picture does not.
TEST(SparsePicture, TheLastPicturesPixelsMayDifferByMore) {
  const auto drawn_of = [](double height) {
    Canvas canvas{[=](glm::vec2 place) { return place.x > 0.0F ? 0.3 + height : 0.3; }, {128, 96}};
    canvas.Complete(kContrast);
    return canvas.drawn;
  };
  // A step of one and a half times the contrast requires rays only in the half-size picture: 4
  // columns of 48 pixels.
  EXPECT_EQ(drawn_of(1.5 * kContrast / 255.0), 4U * 48U);
  EXPECT_GT(drawn_of(1.5 * kLastContrast * kContrast / 255.0), 4U * 48U);
}

TEST(SparsePicture, AnEdgeIsAsSharpAsWithARayForEachPixel) {
  for (const glm::ivec2& size_px : {glm::ivec2(128, 96), glm::ivec2(121, 83)}) {
    Canvas canvas{[](glm::vec2 place) { return place.x + 0.4F * place.y > 0.13F ? 0.8 : 0.3; },
                  size_px};
    const auto rgb = canvas.Complete(kContrast);
    EXPECT_LE(canvas.WorstOf(rgb, 0), 1.05);
    const double share = static_cast<double>(canvas.drawn) / (size_px.x * size_px.y);
    EXPECT_GT(share, 0.01);
    EXPECT_LT(share, 0.25);
  }
}

TEST(SparsePicture, WithoutAnyContrastEveryPixelHasItsRay) {
  Canvas canvas{[](glm::vec2 place) { return 0.5 + 0.4 * std::sin(40.0 * place.x * place.y); },
                {60, 44}};
  EXPECT_LE(canvas.WorstOf(canvas.Complete(-1), 0), 1.05);
  EXPECT_EQ(canvas.drawn, 30U * 22U + 60U * 44U);
}

TEST(SparsePicture, AFailureOfTheRaysIsHandedOn) {
  const auto whole = CompletePicture(
      {1, 1, {1, 2, 3}}, {4, 4}, -1,
      [](const std::vector<glm::vec2>&) -> absl::StatusOr<std::vector<std::uint16_t>> {
        return absl::UnavailableError("no device");
      });
  EXPECT_EQ(whole.status(), absl::UnavailableError("no device"));
}

}  // namespace
}  // namespace thunderhead::frame
