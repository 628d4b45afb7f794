#include "volume/detail_control.h"

#include <cmath>
#include <vector>

#include "gtest/gtest.h"

namespace thunderhead::volume {
namespace {

using physics::Hydrometeor;

// Returns a block of one hydrometeor, thick enough to be opaque, in the middle of 16 x 16 x 16
// cells.
HydrometeorFields BlockOf(Hydrometeor hydrometeor) {
  HydrometeorFields fields;
  fields.grid.cells = glm::ivec3(16);
  fields.grid.spacing_m = glm::dvec3(100.0);
  HydrometeorField field;
  field.hydrometeor = hydrometeor;
  field.concentration_kg_per_m3.assign(fields.grid.CellCount(), 0.0F);
  for (int z = 3; z < 13; ++z) {
    for (int y = 3; y < 13; ++y) {
      for (int x = 3; x < 13; ++x) {
        field.concentration_kg_per_m3[fields.grid.Offset(x, y, z)] = 1.0F;
      }
    }
  }
  fields.fields.push_back(field);
  fields.condensate = {glm::ivec3(3), glm::ivec3(13)};
  return fields;
}

struct Control {
  ExtinctionVolume volume;
  DetailControl texels;

  explicit Control(const HydrometeorFields& fields) {
    const std::vector<ExtinctionTerm> terms = {{0, 1.0F, 0, false}};
    volume = ComputeExtinction(fields, terms, 1);
    texels = DetailControlOf(fields, terms, volume);
  }
  const DetailTexel& At(int x, int y, int z) const { return texels[volume.grid.Offset(x, y, z)]; }
  int Profile(int x, int y, int z) const { return At(x, y, z).profile; }
  int Amplitude(int x, int y, int z) const { return At(x, y, z).amplitude - 128; }
};

void SetTurbulence(std::uint8_t turbulence, HydrometeorFields* fields) {
  fields->motion.source = TurbulenceSource::kEnergy;
  fields->motion.turbulence.assign(fields->grid.CellCount(), turbulence);
}

void SetAscent(float ascent_m_per_s, HydrometeorFields* fields) {
  fields->motion.ascent.assign(fields->grid.CellCount(),
                               static_cast<std::uint8_t>(ascent_m_per_s / kAscentUnit_m_per_s));
}

TEST(DetailControl, ProfileRisesFromEmptyCellsInwards) {
  const Control control(BlockOf(Hydrometeor::kCloud));
  ASSERT_EQ(control.volume.grid.cells, glm::ivec3(12));  // with a border of empty cells
  EXPECT_EQ(control.At(0, 5, 5).occupied, 0);
  EXPECT_EQ(control.At(1, 5, 5).occupied, 255);
  EXPECT_GT(control.Profile(0, 5, 5), 0);
  EXPECT_LT(control.Profile(0, 5, 5), 127);
  // The surface is nearly at the face between the two cells.
  EXPECT_NEAR(control.Profile(0, 5, 5) + control.Profile(1, 5, 5), 255, 20);
  EXPECT_LT(control.Profile(0, 1, 1), control.Profile(0, 5, 5));
  EXPECT_GT(control.Profile(1, 5, 5), 100);
  EXPECT_GT(control.Profile(2, 5, 5), control.Profile(1, 5, 5));
  EXPECT_EQ(control.Profile(5, 5, 5), 255);
  EXPECT_LT(control.Profile(1, 1, 1), control.Profile(1, 5, 5));  // corners are rounded
}

constexpr std::uint8_t kWeak = 60;  // weak turbulence, on a scale up to 255

TEST(DetailControl, CloudWaterThatCondensesHasBillows) {
  HydrometeorFields fields = BlockOf(Hydrometeor::kCloud);
  SetTurbulence(kWeak, &fields);
  EXPECT_GT(Control(fields).Amplitude(5, 5, 5), 20);
  SetAscent(5.0F, &fields);
  EXPECT_GT(Control(fields).Amplitude(5, 5, 5), 20);
  SetAscent(0.0F, &fields);
  EXPECT_EQ(Control(fields).Amplitude(5, 5, 5), 0);
}

TEST(DetailControl, IceHasFibresUnlessItIsStirredOrRisesFast) {
  HydrometeorFields fields = BlockOf(Hydrometeor::kIce);
  SetTurbulence(kWeak, &fields);
  EXPECT_LT(Control(fields).Amplitude(5, 5, 5), -20);
  SetAscent(0.5F, &fields);
  EXPECT_LT(Control(fields).Amplitude(5, 5, 5), -20);
  SetAscent(30.0F, &fields);
  EXPECT_GT(Control(fields).Amplitude(5, 5, 5), 20);
  SetAscent(0.0F, &fields);
  SetTurbulence(255, &fields);
  EXPECT_GT(Control(fields).Amplitude(5, 5, 5), 110);
}

TEST(DetailControl, RainIsSmooth) {
  HydrometeorFields fields = BlockOf(Hydrometeor::kRain);
  SetTurbulence(255, &fields);
  EXPECT_EQ(Control(fields).Amplitude(5, 5, 5), 0);
}

TEST(DetailControl, AmplitudeFollowsTurbulence) {
  HydrometeorFields fields = BlockOf(Hydrometeor::kCloud);
  SetTurbulence(255, &fields);
  const int full = Control(fields).Amplitude(5, 5, 5);
  SetTurbulence(85, &fields);
  EXPECT_NEAR(Control(fields).Amplitude(5, 5, 5), full / 3.0, 1.5);
  SetTurbulence(0, &fields);
  EXPECT_EQ(Control(fields).Amplitude(5, 5, 5), 0);
}

TEST(DetailControl, WithoutTurbulenceAmplitudeFollowsContrast) {
  const Control control(BlockOf(Hydrometeor::kCloud));
  EXPECT_GT(control.Amplitude(1, 5, 5), 50);
  EXPECT_GT(control.Amplitude(0, 5, 5), 50);  // detail is drawn between this cell and its neighbour
  EXPECT_EQ(control.Amplitude(5, 5, 5), 0);
}

}  // namespace
}  // namespace thunderhead::volume
