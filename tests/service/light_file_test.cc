// OpenEXR files of every renderer: light, and the storm's share of each pixel in agreement with the
// optical depth, which is computed apart from it.
#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "picture/exr_file.h"
#include "tests/service/running_program.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::testing {
namespace {

constexpr char kSample[] = THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc";

// What agreement means depends on what a renderer approximates.
struct Renderer {
  std::string name;
  double max_mean_difference;  // of the opacity and 1 - exp(-optical depth)
  std::vector<std::string> flags;
  glm::ivec2 size_px{96, 54};
};

class LightFile : public ::testing::TestWithParam<Renderer> {};

TEST_P(LightFile, OpacityAndOpticalDepthAgree) {
  const TemporaryFolder folder;
  const std::string file = folder.File("storm.exr");
  std::vector<std::string> arguments = {
      "render",   kSample,
      "-o",       file,
      "--time",   "1",
      "--size",   absl::StrCat(GetParam().size_px.x, "x", GetParam().size_px.y),
      "--device", "software"};
  arguments.insert(arguments.end(), GetParam().flags.begin(), GetParam().flags.end());
  const std::string log = folder.File("log");
  ASSERT_EQ(RunningProgram(PROGRAM, arguments, log, log).Wait().code, 0);
  const auto picture = picture::ReadExr(file);
  ASSERT_TRUE(picture.ok()) << picture.status();
  ASSERT_EQ(picture->size_px, GetParam().size_px);
  const auto pixels = static_cast<std::size_t>(GetParam().size_px.x * GetParam().size_px.y);
  ASSERT_EQ(picture->opacity.size(), pixels);
  ASSERT_EQ(picture->optical_depth.size(), pixels);
  ASSERT_EQ(picture->depth_one_distance_m.size(), pixels);
  double difference = 0.0;
  double covered = 0.0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const double expected = 1.0 - std::exp(-picture->optical_depth[i]);
    difference += std::abs(picture->opacity[i] - expected) / static_cast<double>(pixels);
    covered += expected / static_cast<double>(pixels);
    // The distance is there where the depth reaches 1, and only there.
    EXPECT_EQ(std::isfinite(picture->depth_one_distance_m[i]), picture->optical_depth[i] >= 1.0F);
  }
  EXPECT_GT(covered, 0.05) << "no storm in sight";
  EXPECT_LT(covered, 0.95);
  EXPECT_LT(difference, GetParam().max_mean_difference);
  RecordProperty("difference", std::to_string(difference));
}

INSTANTIATE_TEST_SUITE_P(
    Renderers, LightFile,
    ::testing::Values(
        Renderer{"light_volume", 0.01, {"--quality", "fast"}},
        // Detail finer than a pixel is left out of pictures, and counts for the depth: fewer than
        // 0.02 at 96 x 54 pixels, and less the finer they are.
        Renderer{"light_volume_with_detail", 0.01, {"--renderer", "light_volume"}, {384, 216}},
        Renderer{"half_angle", 0.02, {"--renderer", "half_angle"}},
        // Balls smooth the storm's edges; a surface has none that are thin.
        Renderer{"metaball", 0.1, {"--renderer", "metaball"}},
        Renderer{"cumulus", 0.2, {"--renderer", "cumulus"}},
        // 32 samples a pixel: a standard error of at most 0.09 where half of them meet the storm.
        Renderer{"reference", 0.03, {"--renderer", "reference", "--spp", "32"}}),
    [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace thunderhead::testing
