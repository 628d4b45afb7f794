// Tests of schemes whose variables hold both phases of water.
#include "storm_files/wrf_phases.h"

#include "tests/unit/storm_files/wrf_kind_test.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::SyntheticWrf;
using testing::WrfCell;

// The temperature is the potential temperature times this factor at 80 kPa.
constexpr double kExner = 0.938235;

class WrfPhasesTest : public WrfKindTest {
 protected:
  // A file with this temperature in all layers.
  static SyntheticWrf At(double temperature_K, int microphysics) {
    SyntheticWrf file = Cloud();
    file.mixing_ratios["QRAIN"] = [](const WrfCell&) { return 2e-3; };
    file.microphysics = microphysics;
    file.potential_temperature_K = temperature_K / kExner;
    return file;
  }

  // Returns the largest amount of each field, in the order of physics::kHydrometeors.
  std::vector<float> Largest(const SyntheticWrf& file) {
    const auto fields = Read(file);
    EXPECT_TRUE(fields.ok()) << fields.status();
    std::vector<float> largest;
    if (!fields.ok()) return largest;
    for (const auto& field : fields->fields) largest.push_back(field.statistics.maximum);
    return largest;
  }
};

constexpr int kKessler = 1;
constexpr int kWsm3 = 3;
constexpr int kWsm6 = 6;

TEST_F(WrfPhasesTest, Wsm3HasIceBelowFreezingOnly) {
  const auto warm = Largest(At(273.3, kWsm3));
  EXPECT_THAT(warm, ElementsAre(1e-3F, 2e-3F, 0.0F, 0.0F));
  const auto cold = Largest(At(273.0, kWsm3));
  EXPECT_THAT(cold, ElementsAre(0.0F, 0.0F, 1e-3F, 2e-3F));
}

TEST_F(WrfPhasesTest, KesslerIsMixedFromMinus40ToZero) {
  const auto near = [](float value) { return ::testing::FloatNear(value, 1e-6F); };
  EXPECT_THAT(Largest(At(280.0, kKessler)), ElementsAre(1e-3F, 2e-3F, 0.0F, 0.0F));
  EXPECT_THAT(Largest(At(263.15, kKessler)),
              ElementsAre(near(0.75e-3F), near(1.5e-3F), near(0.25e-3F), near(0.5e-3F)));
  EXPECT_THAT(Largest(At(230.0, kKessler)), ElementsAre(0.0F, 0.0F, 1e-3F, 2e-3F));
}

TEST_F(WrfPhasesTest, TheSplitKeepsTheMass) {
  SyntheticWrf file = At(280.0, kWsm6);
  file.potential_temperature_at_K = [](const WrfCell& cell) {
    return (285.0 - 8.0 * cell.level) / kExner;
  };
  const auto whole = Read(file);
  ASSERT_TRUE(whole.ok()) << whole.status();
  for (const int scheme : {kKessler, kWsm3}) {
    file.microphysics = scheme;
    const auto split = Read(file);
    ASSERT_TRUE(split.ok()) << split.status();
    ASSERT_EQ(split->fields.size(), 4U);
    EXPECT_EQ(split->fields[2].hydrometeor, Hydrometeor::kIce);
    EXPECT_EQ(split->fields[3].hydrometeor, Hydrometeor::kSnow);
    EXPECT_EQ(split->fields[3].variable, "QRAIN");
    for (const std::size_t liquid : {0U, 1U}) {
      EXPECT_GT(ColumnPath(*split, liquid, 1, 1), 0.1);
      EXPECT_NEAR(ColumnPath(*split, liquid, 1, 1) + ColumnPath(*split, liquid + 2, 1, 1),
                  ColumnPath(*whole, liquid, 1, 1), 1e-5);
    }
  }
}

TEST_F(WrfPhasesTest, TheSplitIsReported) {
  auto described = Describe(At(280.0, kWsm3));
  ASSERT_TRUE(described.ok()) << described.status();
  EXPECT_THAT(Assumptions(*described), HasSubstr("QCLOUD and QRAIN is ice below 0 C"));
  described = Describe(At(280.0, kKessler));
  ASSERT_TRUE(described.ok()) << described.status();
  EXPECT_THAT(Assumptions(*described), HasSubstr("ice below -40 C"));
  described = Describe(At(280.0, kWsm6));
  ASSERT_TRUE(described.ok()) << described.status();
  EXPECT_TRUE(described->assumptions.empty());
}

// The scheme may have one variable for both phases, so the file does not say that its water is
// liquid.
TEST_F(WrfPhasesTest, WaterOfAnUnknownSchemeIsSaidToBeLiquid) {
  SyntheticWrf file = At(250.0, 0);
  auto described = Describe(file);
  ASSERT_TRUE(described.ok()) << described.status();
  EXPECT_THAT(Assumptions(*described),
              HasSubstr("Water in QCLOUD and QRAIN is taken as liquid at all temperatures"));
  EXPECT_THAT(Largest(file), ElementsAre(1e-3F, 2e-3F));
  file.mixing_ratios["QSNOW"] = [](const WrfCell&) { return 5e-4; };
  described = Describe(file);
  ASSERT_TRUE(described.ok()) << described.status();
  EXPECT_THAT(described->assumptions, ::testing::IsEmpty());
}

TEST_F(WrfPhasesTest, AFrozenPhaseOfTheFileIsKept) {
  SyntheticWrf file = At(250.0, kWsm3);
  file.mixing_ratios["QICE"] = [](const WrfCell&) { return 5e-4; };
  EXPECT_THAT(Largest(file), ElementsAre(1e-3F, 0.0F, 5e-4F, 2e-3F));
}

TEST_F(WrfPhasesTest, CategoriesOfIceAreAdded) {
  SyntheticWrf file;
  for (const char* name : {"QICE", "QICE2", "QICE3"}) {
    file.mixing_ratios[name] = [](const WrfCell&) { return 1e-4; };
  }
  EXPECT_THAT(Largest(file), ElementsAre(::testing::FloatEq(3e-4F)));
}

}  // namespace
}  // namespace thunderhead::storm_files
