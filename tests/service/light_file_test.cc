// Tests of the OpenEXR files of every renderer: radiance, and the storm's opacity in each pixel.
// The opacity must agree with the optical depth, which is computed separately.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "gtest/gtest.h"
#include "picture/exr_file.h"
#include "tests/service/running_program.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::testing {
namespace {

constexpr char kLitSample[] = THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc";

// A technique and its flags. A transport attenuates the background by the storm's optical depth or
// by a part of it (TransportOpacity below). Opacity is therefore never above 1 - exp(-depth), and
// it is nearly 1 where the storm is deep.
struct Renderer {
  std::string name;
  std::vector<std::string> flags;
  // For a technique that draws shapes instead of the fields: the permitted mean difference of the
  // opacity from 1 - exp(-depth). It is 0 for other techniques.
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
  std::vector<std::string> arguments = {"render", kLitSample, "-o",    file,       "--time",
                                        "1",      "--size",   "96x54", "--device", "software"};
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
  double above = 0.0;  // opacity above the depth's limit; the noise of traced pixels averages out
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
    // The distance is finite exactly where the depth reaches 1.
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
                                           Renderer{"half_angle", {"--technique", "half_angle"}},
                                           Renderer{"metaball", {"--technique", "metaball"}, 0.1},
                                           // This renderer shows only cloud water and ice.
                                           Renderer{"cumulus", {"--technique", "cumulus"}, 0.2},
                                           Renderer{"reference",
                                                    {"--technique", "reference", "--spp", "32"}}),
                         [](const auto& each) { return each.param.name; });

// One field with a phase function in closed form, that of Henyey and Greenstein.
constexpr double kAsymmetry = 0.85;
constexpr char kScene[] = R"({"camera": {"topDown": {}}, "rendering": {%s}, "fields": [
    {"hydrometeor": "HYDROMETEOR_CLOUD",
     "phase": {"kind": "KIND_HENYEY_GREENSTEIN", "asymmetry": 0.85}},
    {"hydrometeor": "HYDROMETEOR_RAIN", "visible": false},
    {"hydrometeor": "HYDROMETEOR_ICE", "visible": false},
    {"hydrometeor": "HYDROMETEOR_SNOW", "visible": false},
    {"hydrometeor": "HYDROMETEOR_GRAUPEL", "visible": false}]})";

// Returns the share of light that counts as unscattered. It is the light scattered by less than 10
// degrees (half of the setting theta_f), above what a phase function that is flat there would
// scatter.
double CutShare() {
  const double cosine = std::cos(std::numbers::pi / 18.0);
  const double g = kAsymmetry;
  const double at_angle = 1.0 + g * g - 2.0 * g * cosine;
  const double within = (1.0 - g * g) / (2.0 * g) * (1.0 / (1.0 - g) - 1.0 / std::sqrt(at_angle));
  const double flat = 0.5 * (1.0 - cosine) * (1.0 - g * g) / std::pow(at_angle, 1.5);
  return within - flat;
}

// A transport, and the share of the optical depth through which it sees the background.
struct Transport {
  std::string name;
  std::string rendering;
  double seen_share = 1.0;
  double tolerance = 0.01;  // permitted difference of a pixel's opacity

  friend void PrintTo(const Transport& transport, std::ostream* out) { *out << transport.name; }
};

class TransportOpacity : public ::testing::TestWithParam<Transport> {};

// Diffused light continues by its mean cosine, so the background counts as lit through the
// transport depth, (1 - g) depth. The storm is not opaque below a depth of some 20, although no
// unscattered ray would pass.
TEST_P(TransportOpacity, IsOfTheDepthThatItSeesThrough) {
  const TemporaryFolder folder;
  const std::string scene = folder.File("scene.json");
  std::ofstream(scene) << absl::StrFormat(kScene, GetParam().rendering);
  const std::string file = folder.File("storm.exr");
  const std::string log = folder.File("log");
  ASSERT_EQ(RunningProgram(PROGRAM,
                           {"render", kLitSample, "-o", file, "--time", "1", "--size", "96x54",
                            "--scene", scene, "--device", "software"},
                           log, log)
                .Wait()
                .code,
            0);
  const auto picture = picture::ReadExr(file);
  ASSERT_TRUE(picture.ok()) << picture.status();
  int between = 0;
  Mean share;
  for (std::size_t i = 0; i < picture->opacity.size(); ++i) {
    const double depth = picture->optical_depth[i];
    const double expected = 1.0 - std::exp(-GetParam().seen_share * depth);
    // Rays end when the storm's transmittance is nearly 0, so an opacity near 1 is only
    // approximate.
    if (expected > 0.94) {
      EXPECT_GT(picture->opacity[i], 0.93);
      continue;
    }
    EXPECT_NEAR(picture->opacity[i], expected, GetParam().tolerance) << "depth " << depth;
    if (depth < 0.1) continue;
    share.Add(-std::log(1.0 - picture->opacity[i]) / depth);
    ++between;
  }
  EXPECT_GT(between, 200);
  EXPECT_NEAR(share.Of(), GetParam().seen_share, 0.01 * GetParam().seen_share);
}

INSTANTIATE_TEST_SUITE_P(
    Transports, TransportOpacity,
    ::testing::Values(
        Transport{"diffusion", R"("lightVolume": {"detail": false})", 1.0 - kAsymmetry},
        Transport{"consistent",
                  R"("lightVolume": {"detail": false, "transport": "TRANSPORT_CONSISTENT"})",
                  1.0 - CutShare()},
        // The slices are coarser than cells.
        Transport{"half_angle", R"("halfAngle": {"slices": 256})", 1.0 - CutShare(), 0.03}),
    [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace thunderhead::testing
