// Tests of the medium as seen by the light of the light volume, compared with the medium's own code
// without GL.
#include "renderers/light_volume/light_medium.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "base/half_float.h"
#include "gl/context.h"
#include "gtest/gtest.h"
#include "scene/detailed_medium.h"
#include "scene/drawn_fields.h"
#include "storm_store/storm_store.h"
#include "tests/support/gl_context.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

class LightMediumTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    const auto store =
        *storm_store::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc"}, {});
    fields_ = *store->Get(store->Storms().front()->id, 1, {});
    scene_ = test_support::PlainScene();
    programs_ = std::make_shared<gl::ProgramCache>();
  }

  GroupWeights WeightsOf(const ResidentMedium& medium) const {
    return {medium.Content(), std::get<scene::LightVolume>(scene_.rendering.technique).medium};
  }

  // Returns the extinction of light at cells, or the transport extinction, in 1/m.
  std::vector<double> Made(LightMedium* light, const ResidentMedium& medium,
                           bool transport = false) {
    const absl::Status status = light->Update(medium, WeightsOf(medium), transport);
    EXPECT_TRUE(status.ok()) << status;
    return TexelsOf(*light, medium, transport ? GL_GREEN : GL_RED);
  }

  static std::vector<double> TexelsOf(const LightMedium& light, const ResidentMedium& medium,
                                      GLenum channel) {
    std::vector<std::uint16_t> halves(medium.Bounds().grid.CellCount());
    light.Texture().Download(channel, GL_HALF_FLOAT, halves.size() * sizeof(std::uint16_t),
                             halves.data());
    std::vector<double> values;
    for (const std::uint16_t half : halves) {
      values.push_back(base::FloatFromHalf(half) * light.PerMetre());
    }
    return values;
  }

  // Returns the mean of the medium over each cell, from `samples` along each side, in 1/m.
  std::vector<double> Expected(const ResidentMedium& medium, const std::vector<double>& weights,
                               int samples) {
    const auto detailed = scene::DetailedMedium::Of(scene_, *fields_, medium.Variant().details > 0);
    const std::vector<volume::ExtinctionTerm>& terms = medium.Content().terms;
    const volume::RegularGrid& grid = medium.Bounds().grid;
    std::vector<double> values;
    for (int z = 0; z < grid.cells.z; ++z) {
      for (int y = 0; y < grid.cells.y; ++y) {
        for (int x = 0; x < grid.cells.x; ++x) {
          double sum = 0.0;
          for (int k = 0; k < samples * samples * samples; ++k) {
            const glm::ivec3 at(k % samples, k / samples % samples, k / (samples * samples));
            const glm::dvec3 within = (glm::dvec3(at) + 0.5) / static_cast<double>(samples);
            const auto by_field = detailed->At_per_m(
                grid.low_corner_m + (glm::dvec3(x, y, z) + within) * grid.spacing_m);
            for (std::size_t i = 0; i < terms.size(); ++i) {
              sum += weights[static_cast<std::size_t>(terms[i].channel)] * by_field[i];
            }
          }
          values.push_back(sum / (samples * samples * samples));
        }
      }
    }
    return values;
  }

  std::unique_ptr<gl::Context> context_;
  std::shared_ptr<const volume::HydrometeorFields> fields_;
  scene::Scene scene_;
  std::shared_ptr<gl::ProgramCache> programs_;
  DetailNoises noises_;
  ResidentMedium::Cost cost_;
};

// Returns the mean of |a - b| over the mean of b.
double Off(const std::vector<double>& a, const std::vector<double>& b) {
  double off = 0.0;
  double all = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    off += std::abs(a[i] - b[i]);
    all += b[i];
  }
  return off / all;
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

TEST_F(LightMediumTest, WithoutDetailIsTheMediumAtCells) {
  test_support::SetMode(&scene_.rendering.technique, test_support::kPerFieldPhase);
  const ResidentMedium medium(scene_, *fields_, &noises_, &cost_);
  LightMedium light(programs_);
  // The tolerance is for the half floats of the medium and of the light medium.
  EXPECT_LT(Off(Made(&light, medium), Expected(medium, WeightsOf(medium).light, 1)), 1e-3);
}

TEST_F(LightMediumTest, WithDetailIsTheMeanOverEachCell) {
  test_support::SetMode(&scene_.rendering.technique, test_support::kWithDetail);
  const ResidentMedium medium(scene_, *fields_, &noises_, &cost_);
  ASSERT_GT(medium.Variant().details, 0);
  LightMedium light(programs_);
  const std::vector<double> made = Made(&light, medium);
  const std::vector<double> expected = Expected(medium, WeightsOf(medium).light, 4);
  EXPECT_NEAR(Mean(made) / Mean(expected), 1.0, 0.02);
  // The measured value is 0.038; it would be 0.066 with the medium at the cells' centres.
  EXPECT_LT(Off(made, expected), 0.05);
}

TEST_F(LightMediumTest, HasTransportWhereItIsAskedFor) {
  test_support::SetMode(&scene_.rendering.technique, test_support::kPerFieldPhase);
  std::get<scene::LightVolume>(scene_.rendering.technique).medium.transport =
      scene::Transport::kConsistent;
  const ResidentMedium medium(scene_, *fields_, &noises_, &cost_);
  LightMedium light(programs_);
  Made(&light, medium);  // without transport extinction
  const GroupWeights weights = WeightsOf(medium);
  EXPECT_LT(Off(Made(&light, medium, true), Expected(medium, weights.transport, 1)), 1e-3);
  EXPECT_LT(Off(TexelsOf(light, medium, GL_RED), Expected(medium, weights.light, 1)), 1e-3);
}

TEST_F(LightMediumTest, IsMadeAnewForOtherFieldsOrWeightsAlone) {
  test_support::SetMode(&scene_.rendering.technique, test_support::kPerFieldPhase);
  const ResidentMedium medium(scene_, *fields_, &noises_, &cost_);
  LightMedium light(programs_);
  const std::vector<double> before = Made(&light, medium);
  const double most = std::ranges::max(before);
  for (scene::FieldParameters& field : scene_.fields) field.scale *= 0.25F;
  const ResidentMedium thinner(scene_, *fields_, &noises_, &cost_);
  EXPECT_NEAR(std::ranges::max(Made(&light, thinner)) / most, 0.25, 0.001);
  EXPECT_EQ(Made(&light, medium), before);

  GroupWeights half = WeightsOf(medium);
  for (double& weight : half.light) weight *= 0.5;
  ASSERT_TRUE(light.Update(medium, half, false).ok());
  EXPECT_NEAR(std::ranges::max(TexelsOf(light, medium, GL_RED)) / most, 0.5, 0.001);

  // An update that changes nothing does not recompute the texture: what has been cleared stays
  // cleared.
  glClearTexImage(light.Texture().Get(), 0, GL_RED, GL_HALF_FLOAT, nullptr);
  ASSERT_TRUE(light.Update(medium, half, false).ok());
  EXPECT_EQ(std::ranges::max(TexelsOf(light, medium, GL_RED)), 0.0);
}

}  // namespace
}  // namespace thunderhead::renderers
