// OpenEXR files of every renderer: light, and the storm's share of each pixel in agreement with the
// optical depth, which is computed apart from it.
#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "picture/exr_file.h"
#include "tests/service/running_program.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::testing {
namespace {

constexpr char kSample[] = THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc";

// Light that particles scatter forwards by a small angle counts as unscattered in pictures, so
// their opacity is that of a part of the optical depth: never above 1 - exp(-depth), and 1 where
// the storm is deep.
struct Renderer {
  std::string name;
  std::vector<std::string> flags;
  // Of one that draws shapes in the fields' place: the mean difference from 1 - exp(-depth); 0:
  // none.
  double shape_difference = 0.0;

  friend void PrintTo(const Renderer& renderer, std::ostream* out) { *out << renderer.name; }
};

struct Mean {
  double sum = 0.0;
  int count = 0;
  void Add(double value) {
    sum += value;
    ++count;
  }
  double Of() const { return sum / std::max(count, 1); }
};

class LightFile : public ::testing::TestWithParam<Renderer> {};

TEST_P(LightFile, OpacityAndOpticalDepthAgree) {
  const TemporaryFolder folder;
  const std::string file = folder.File("storm.exr");
  std::vector<std::string> arguments = {"render", kSample,  "-o",    file,       "--time",
                                        "1",      "--size", "96x54", "--device", "software"};
  arguments.insert(arguments.end(), GetParam().flags.begin(), GetParam().flags.end());
  const std::string log = folder.File("log");
  ASSERT_EQ(RunningProgram(PROGRAM, arguments, log, log).Wait().code, 0);
  const auto picture = picture::ReadExr(file);
  ASSERT_TRUE(picture.ok()) << picture.status();
  ASSERT_EQ(picture->size_px, glm::ivec2(96, 54));
  const std::size_t pixels = std::size_t{96} * 54;
  ASSERT_EQ(picture->opacity.size(), pixels);
  ASSERT_EQ(picture->optical_depth.size(), pixels);
  ASSERT_EQ(picture->depth_one_distance_m.size(), pixels);
  double above = 0.0;  // what a depth allows; the noise of traced pixels averages out
  double difference = 0.0;
  double covered = 0.0;
  Mean clear;
  Mean deep;
  for (std::size_t i = 0; i < pixels; ++i) {
    const float depth = picture->optical_depth[i];
    const double most = 1.0 - std::exp(-depth);
    above += (picture->opacity[i] - most) / static_cast<double>(pixels);
    difference += std::abs(picture->opacity[i] - most) / static_cast<double>(pixels);
    covered += most / static_cast<double>(pixels);
    if (depth < 1e-4F) clear.Add(picture->opacity[i]);
    if (depth > 30.0F) deep.Add(picture->opacity[i]);
    // The distance is there where the depth reaches 1, and only there.
    EXPECT_EQ(std::isfinite(picture->depth_one_distance_m[i]), depth >= 1.0F);
  }
  EXPECT_GT(covered, 0.05) << "no storm in sight";
  EXPECT_LT(covered, 0.95);
  if (GetParam().shape_difference > 0.0) {
    EXPECT_LT(difference, GetParam().shape_difference);
    return;
  }
  EXPECT_LT(above, 0.001);
  EXPECT_LT(clear.Of(), 0.001);
  EXPECT_GT(deep.Of(), 0.99);
}

INSTANTIATE_TEST_SUITE_P(Renderers, LightFile,
                         ::testing::Values(Renderer{"light_volume", {"--quality", "fast"}},
                                           Renderer{"half_angle", {"--renderer", "half_angle"}},
                                           Renderer{"metaball", {"--renderer", "metaball"}, 0.1},
                                           // Shows cloud water and ice alone.
                                           Renderer{"cumulus", {"--renderer", "cumulus"}, 0.2},
                                           Renderer{"reference",
                                                    {"--renderer", "reference", "--spp", "32"}}),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace thunderhead::testing
