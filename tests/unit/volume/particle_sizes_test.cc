// Tests of effective radii and numbers of particles from synthetic files. Extinction by cell must
// keep each column's optical depth through the remapping.
#include "volume/particle_sizes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "physics/particle_size.h"
#include "storm_files/wrf_reader.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::volume {
namespace {

using physics::Hydrometeor;
using physics::SizeSource;
using testing::SyntheticWrf;
using testing::WrfCell;

// The density of SyntheticWrf's air (see layer_air_test).
constexpr double kAir_kg_per_m3 = 0.94321;

class ParticleSizesTest : public ::testing::Test {
 protected:
  HydrometeorFields Read(const SyntheticWrf& file) {
    const std::string path = folder_.File("wrfout");
    testing::WriteWrf(file, path);
    const auto metadata = storm_files::ReadWrfMetadata(path);
    EXPECT_TRUE(metadata.ok()) << metadata.status();
    auto fields = storm_files::ReadWrfTime(*metadata, 0, std::nullopt, {});
    EXPECT_TRUE(fields.ok()) << fields.status();
    return *std::move(fields);
  }

  testing::TemporaryFolder folder_;
};

// Returns the optical depth of a column with `mass_extinction`.
double ColumnDepth(const HydrometeorFields& fields, const MassExtinction& mass_extinction, int x,
                   int y) {
  double depth = 0.0;
  for (int z = 0; z < fields.grid.cells.z; ++z) {
    float sum = 0.0F;
    AddExtinction(fields.fields[0], mass_extinction, fields.grid.Offset(x, y, z), 1, &sum);
    depth += sum * fields.grid.spacing_m.z;
  }
  return depth;
}

// The mixing ratio and radius of a cloud over sloping ground whose droplets grow with height.
double MixingRatio(const WrfCell& cell) { return 1e-4 * (1 + cell.level % 5); }
double Radius_m(const WrfCell& cell) { return 2e-6 * (1 + cell.level) * (1 + 0.1 * cell.x); }

SyntheticWrf SizedCloud() {
  SyntheticWrf file;
  file.nx = 7;
  file.levels = 24;
  file.terrain_m = [](int x, int y) { return 130.0 * x + 20.0 * y; };
  file.mixing_ratios["QCLOUD"] = MixingRatio;
  file.mixing_ratios["RE_CLOUD"] = Radius_m;
  file.units["RE_CLOUD"] = "m";
  return file;
}

TEST_F(ParticleSizesTest, ColumnsKeepTheOpticalDepthOfTheirLayers) {
  const SyntheticWrf file = SizedCloud();
  const HydrometeorFields fields = Read(file);
  const HydrometeorField& cloud = fields.fields[0];
  EXPECT_EQ(cloud.sizes.name, "RE_CLOUD");
  const auto& optics = physics::DefaultOptics(Hydrometeor::kCloud);
  const MassExtinction by_cell = MassExtinctionOf(cloud, optics, SizeSource::kModel);
  EXPECT_TRUE(by_cell.by_cell);
  for (int y = 0; y < file.ny; ++y) {
    for (int x = 0; x < file.nx; ++x) {
      double expected = 0.0;
      for (int level = 0; level < file.levels; ++level) {
        const WrfCell cell{x, y, level, 0};
        const double thickness_m =
            InterfaceHeight_m(file, {x, y, level + 1, 0}) - InterfaceHeight_m(file, cell);
        expected += 3.0 * kAir_kg_per_m3 * MixingRatio(cell) / (2.0 * 1000.0 * Radius_m(cell)) *
                    thickness_m;
      }
      EXPECT_NEAR(ColumnDepth(fields, by_cell, x, y) / expected, 1.0, 1e-3) << x << " " << y;
    }
  }
}

TEST_F(ParticleSizesTest, ThePapersConstantsAndAGivenRadiusComeFirst) {
  const HydrometeorFields fields = Read(SizedCloud());
  const HydrometeorField& cloud = fields.fields[0];
  auto optics = physics::DefaultOptics(Hydrometeor::kCloud);
  optics.radius_m = 2e-5F;
  const MassExtinction papers = MassExtinctionOf(cloud, optics, SizeSource::kPapers);
  EXPECT_FALSE(papers.by_cell);
  EXPECT_FLOAT_EQ(papers.m2_per_kg, 150.0F);
  const MassExtinction given = MassExtinctionOf(cloud, optics, SizeSource::kGiven);
  EXPECT_FALSE(given.by_cell);
  EXPECT_FLOAT_EQ(given.m2_per_kg, 75.0F);
  EXPECT_EQ(WithDrawnRadius(cloud, optics, SizeSource::kPapers).radius_m, 1e-5F);
  EXPECT_EQ(WithDrawnRadius(cloud, optics, SizeSource::kGiven).radius_m, 2e-5F);
  const float mean_m = cloud.sizes.mean_radius_m;
  EXPECT_EQ(WithDrawnRadius(cloud, optics, SizeSource::kModel).radius_m, mean_m);
  EXPECT_GT(mean_m, 2e-6F);
  EXPECT_LT(mean_m, 8e-5F);
}

TEST_F(ParticleSizesTest, FollowFromNumbers) {
  SyntheticWrf file;
  file.mixing_ratios["QRAIN"] = [](const WrfCell&) { return 1e-3; };
  file.mixing_ratios["QNRAIN"] = [](const WrfCell& cell) { return cell.x == 0 ? 0.0 : 2000.0; };
  file.units["QNRAIN"] = "  kg(-1)";
  const HydrometeorFields fields = Read(file);
  const HydrometeorField& rain = fields.fields[0];
  EXPECT_EQ(rain.sizes.name, "QNRAIN");
  const double expected_m = physics::EffectiveRadius_m(Hydrometeor::kRain, 5e-7F);
  const std::size_t counted = fields.grid.Offset(1, 1, 3);
  EXPECT_NEAR(InverseRadius_per_m(rain.sizes, counted) * expected_m, 1.0, 1e-3);
  EXPECT_EQ(rain.sizes.origin, SizeOrigin::kNumber);
  // The file has a number of drops of 0 in this cell, so the cell gets the observed default radius.
  const std::size_t uncounted = fields.grid.Offset(0, 1, 3);
  EXPECT_NEAR(InverseRadius_per_m(rain.sizes, uncounted) * 6.7e-4, 1.0, 1e-3);
}

// Returns the effective radius of a field in cell (1, 1, 3), whose level differs from the levels of
// the other tested cells.
double RadiusIn_m(const HydrometeorFields& fields, std::size_t field) {
  return 1.0 / InverseRadius_per_m(fields.fields[field].sizes, fields.grid.Offset(1, 1, 3));
}

TEST_F(ParticleSizesTest, RadiiComeBeforeNumbersAndTheSchemeLast) {
  SyntheticWrf file = SizedCloud();
  file.microphysics = 6;
  file.mixing_ratios["QCLOUD"] = [](const WrfCell&) { return 1e-3; };
  file.mixing_ratios["RE_CLOUD"] = [](const WrfCell&) { return 1.5e-5; };
  file.mixing_ratios["QNCLOUD"] = [](const WrfCell&) { return 1e8; };
  file.units["QNCLOUD"] = "kg-1";
  HydrometeorFields fields = Read(file);
  EXPECT_EQ(fields.fields[0].sizes.name, "RE_CLOUD");
  EXPECT_EQ(fields.fields[0].sizes.origin, SizeOrigin::kEffectiveRadius);
  EXPECT_NEAR(RadiusIn_m(fields, 0), 1.5e-5, 1e-8);
  file.units["RE_CLOUD"] = "furlong";
  fields = Read(file);
  EXPECT_EQ(fields.fields[0].sizes.name, "QNCLOUD") << "unfit variables are left out";
  EXPECT_EQ(fields.fields[0].sizes.origin, SizeOrigin::kNumber);
  EXPECT_NEAR(RadiusIn_m(fields, 0), 1.1157 * 13.365e-6, 1e-8);
  file.omitted = {"RE_CLOUD", "QNCLOUD"};
  fields = Read(file);
  EXPECT_EQ(fields.fields[0].sizes.name, "WSM6");
  EXPECT_EQ(fields.fields[0].sizes.origin, SizeOrigin::kScheme);
  // The expected radius is 1.5 / (pi 1000 3e8 / 9.4321e-4)^(1/3) m.
  EXPECT_NEAR(RadiusIn_m(fields, 0), 1.5004e-5, 1e-8);
  file.microphysics = 10;
  fields = Read(file);
  EXPECT_EQ(fields.fields[0].sizes.name, "");
  EXPECT_EQ(fields.fields[0].sizes.origin, SizeOrigin::kObserved);
  EXPECT_TRUE(fields.fields[0].sizes.Empty());
  const auto& optics = physics::DefaultOptics(Hydrometeor::kCloud);
  EXPECT_FLOAT_EQ(MassExtinctionOf(fields.fields[0], optics, SizeSource::kModel).m2_per_kg, 150.0F);
}

// In cells without counted drops, the scheme still provides a radius.
TEST_F(ParticleSizesTest, TheNextSourceFillsTheGapsOfTheOneBefore) {
  SyntheticWrf file;
  file.microphysics = 6;
  file.mixing_ratios["QRAIN"] = [](const WrfCell&) { return 1e-3; };
  file.mixing_ratios["QNRAIN"] = [](const WrfCell&) { return 0.0; };
  file.units["QNRAIN"] = "kg-1";
  const HydrometeorFields fields = Read(file);
  EXPECT_EQ(fields.fields[0].sizes.origin, SizeOrigin::kNumber);
  // The expected radius is 1.5 / (pi 1000 8e6 / 9.4321e-4)^(1/4) m.
  EXPECT_NEAR(RadiusIn_m(fields, 0), 6.602e-4, 1e-6);
}

// The air has 290.86 K. There snow has the intercept of its melting level, and graupel is hail.
TEST_F(ParticleSizesTest, OfTheSchemeFollowFromTheAir) {
  SyntheticWrf file;
  file.microphysics = 6;
  file.hail_option = 1;
  file.mixing_ratios["QSNOW"] = [](const WrfCell&) { return 1e-3; };
  file.mixing_ratios["QGRAUP"] = [](const WrfCell&) { return 1e-3; };
  HydrometeorFields fields = Read(file);
  // The expected radius is 1.5 / (pi 100 2e6 / 9.4321e-4)^(1/4) m.
  EXPECT_NEAR(RadiusIn_m(fields, 0), 1.6604e-3, 2e-6);
  EXPECT_EQ(fields.fields[1].sizes.name, "WSM6 with hail");
  // The expected radius is 1.5 / (pi 700 4e4 / 9.4321e-4)^(1/4) m for hail of 700 kg/m3. The drawn
  // particles have 500 kg/m3.
  EXPECT_NEAR(RadiusIn_m(fields, 1), 2.7143e-3 * 1.4, 4e-6);
  // The air is made colder. It then has 253.30 K and 1.0831 kg/m3.
  file.potential_temperature_K = 270.0;
  fields = Read(file);
  EXPECT_NEAR(RadiusIn_m(fields, 0), 9.478e-4, 2e-6);
}

TEST_F(ParticleSizesTest, OfThompsonAreCountedOrItsOwnOrObserved) {
  SyntheticWrf file;
  file.microphysics = 8;
  for (const char* name : {"QCLOUD", "QRAIN", "QICE", "QSNOW", "QGRAUP"}) {
    file.mixing_ratios[name] = [](const WrfCell&) { return 1e-3; };
  }
  file.mixing_ratios["QNRAIN"] = [](const WrfCell&) { return 2000.0; };
  file.units["QNRAIN"] = "kg-1";
  const HydrometeorFields fields = Read(file);
  ASSERT_EQ(fields.fields.size(), 5U);
  EXPECT_EQ(fields.fields[0].sizes.name, "Thompson");
  EXPECT_EQ(fields.fields[1].sizes.name, "QNRAIN");
  EXPECT_EQ(fields.fields[2].sizes.origin, SizeOrigin::kObserved);
  EXPECT_EQ(fields.fields[3].sizes.origin, SizeOrigin::kObserved);
  EXPECT_EQ(fields.fields[4].sizes.name, "Thompson");
}

// Advection leaves such traces. They have no size, and do not count in the field's sizes.
TEST_F(ParticleSizesTest, OfTracesAreFinite) {
  for (const double trace : {0.0, 1e-42, 1e-38, 1e-30, 1e-13, -1e-13}) {
    SyntheticWrf file;
    file.microphysics = 6;
    for (const char* name : {"QCLOUD", "QRAIN", "QICE", "QSNOW", "QGRAUP"}) {
      file.mixing_ratios[name] = [=](const WrfCell& cell) { return cell.x == 2 ? 1e-3 : trace; };
    }
    const HydrometeorFields fields = Read(file);
    for (const HydrometeorField& field : fields.fields) {
      const auto& optics = physics::DefaultOptics(field.hydrometeor);
      const MassExtinction mass_extinction = MassExtinctionOf(field, optics, SizeSource::kModel);
      ASSERT_TRUE(mass_extinction.by_cell);
      std::vector<float> extinction(fields.grid.CellCount(), 0.0F);
      AddExtinction(field, mass_extinction, 0, extinction.size(), extinction.data());
      for (int x = 0; x < file.nx; ++x) {
        const float there = extinction[fields.grid.Offset(x, 1, 3)];
        EXPECT_TRUE(x == 2 ? there > 1e-4F : there >= 0.0F && there < 1e-7F)
            << physics::NameOf(field.hydrometeor) << " " << trace << " " << x << " " << there;
      }
      EXPECT_GT(field.sizes.mean_radius_m, 1e-5F);
      EXPECT_LT(field.sizes.mean_radius_m, 2e-3F);
    }
  }
}

TEST_F(ParticleSizesTest, NonsenseGivesTheConstantRadius) {
  for (const double radius_m : {0.0, -1.0, 1e-8, 5.0, std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::infinity()}) {
    SyntheticWrf file = SizedCloud();
    file.mixing_ratios["RE_CLOUD"] = [=](const WrfCell& cell) {
      return cell.x == 3 ? 2e-5 : radius_m;
    };
    const HydrometeorFields fields = Read(file);
    const ParticleSizes& sizes = fields.fields[0].sizes;
    const auto radius_at = [&](int x) {
      return 1.0F / InverseRadius_per_m(sizes, fields.grid.Offset(x, 1, 12));
    };
    EXPECT_NEAR(radius_at(1), 1e-5F, 1e-8F) << radius_m;
    EXPECT_NEAR(radius_at(3), 2e-5F, 2e-8F) << radius_m;
  }
}

TEST_F(ParticleSizesTest, AreHeldFromTheFirstCellWithParticlesToTheLast) {
  SyntheticWrf file;
  file.nx = 7;
  file.mixing_ratios["RE_CLOUD"] = Radius_m;
  file.units["RE_CLOUD"] = "m";
  file.mixing_ratios["QCLOUD"] = [](const WrfCell& cell) {
    return cell.level == 3 || cell.level == 4 ? 1e-4 : 0.0;
  };
  const HydrometeorFields sized = Read(file);
  const HydrometeorField& cloud = sized.fields[0];
  const std::size_t layer = std::size_t{7} * 3;
  EXPECT_EQ(cloud.sizes.first_cell % layer, 0U);
  EXPECT_EQ(cloud.sizes.EndCell() % layer, 0U);
  EXPECT_LT(cloud.sizes.inverse_radius.size(), sized.grid.CellCount() / 2);
  for (std::size_t cell = 0; cell < sized.grid.CellCount(); ++cell) {
    const bool held = cell >= cloud.sizes.first_cell && cell < cloud.sizes.EndCell();
    EXPECT_EQ(cloud.concentration_kg_per_m3[cell] > 0.0F, held) << cell;
  }
  // Every division of the cells into two runs gives the same result.
  const auto& optics = physics::DefaultOptics(Hydrometeor::kCloud);
  const MassExtinction by_cell = MassExtinctionOf(cloud, optics, SizeSource::kModel);
  std::vector<float> whole(sized.grid.CellCount(), 0.0F);
  AddExtinction(cloud, by_cell, 0, whole.size(), whole.data());
  for (const std::size_t cut : {std::size_t{1}, 2 * layer, 3 * layer + 5, whole.size() - 1}) {
    std::vector<float> parts(whole.size(), 0.0F);
    AddExtinction(cloud, by_cell, 0, cut, parts.data());
    AddExtinction(cloud, by_cell, cut, parts.size() - cut, parts.data() + cut);
    EXPECT_EQ(parts, whole) << cut;
  }
  file.omitted = {"RE_CLOUD"};
  const HydrometeorFields plain = Read(file);
  EXPECT_TRUE(plain.fields[0].sizes.Empty());
  EXPECT_EQ(plain.fields[0].sizes.name, "");
  EXPECT_EQ(sized.Bytes() - plain.Bytes(),
            cloud.sizes.inverse_radius.size() * sizeof(std::uint16_t));
  EXPECT_FALSE(MassExtinctionOf(plain.fields[0], optics, SizeSource::kModel).by_cell);
}

TEST(InverseRadius, HalvesHoldEveryRadiusThatASceneMayHave) {
  for (double radius_m = physics::kMinRadius_m; radius_m <= physics::kMaxRadius_m;
       radius_m *= 1.07) {
    const auto per_radius = static_cast<float>(1.0 / radius_m);
    const ParticleSizes sizes = SizesOf({}, {2e-3F}, {2e-3F * per_radius});
    EXPECT_NEAR(InverseRadius_per_m(sizes.inverse_radius[0]) * radius_m, 1.0, 6e-4) << radius_m;
  }
}

}  // namespace
}  // namespace thunderhead::volume
