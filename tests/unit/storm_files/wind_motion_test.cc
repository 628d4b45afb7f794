#include "storm_files/wind_motion.h"

#include <cmath>
#include <functional>
#include <limits>

#include "gtest/gtest.h"

namespace thunderhead::storm_files {
namespace {

constexpr double kDx_m = 200.0;
constexpr double kDz_m = 100.0;

using Component = std::function<double(double x_m, double y_m, double z_m)>;

std::vector<float> Faces(const glm::ivec3& cells, int axis, const Component& component) {
  glm::ivec3 size = cells;
  size[axis] += 1;
  const auto at = [&](int i, int along, double spacing_m) {
    return (i + (along == axis ? 0.0 : 0.5)) * spacing_m;
  };
  std::vector<float> values;
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        values.push_back(
            static_cast<float>(component(at(x, 0, kDx_m), at(y, 1, kDx_m), at(z, 2, kDz_m))));
      }
    }
  }
  return values;
}

ModelWind WindOf(const Component& u, const Component& v, const Component& w) {
  const glm::ivec3 cells(5, 4, 6);
  return {.cells = cells,
          .dx_m = kDx_m,
          .dy_m = kDx_m,
          .u_m_per_s = Faces(cells, 0, u),
          .v_m_per_s = Faces(cells, 1, v),
          .w_m_per_s = Faces(cells, 2, w)};
}

std::vector<float> Heights(const glm::ivec3& cells) {
  return Faces(cells, 2, [](double, double, double z_m) { return z_m; });
}

const Component kStill = [](double, double, double) { return 0.0; };

TEST(EnergyOfDeformation, IsZeroInSolidRotation) {
  const ModelWind wind = WindOf([](double, double y_m, double) { return -0.01 * y_m; },
                                [](double x_m, double, double) { return 0.01 * x_m; }, kStill);
  for (const float energy : EnergyOfDeformation(WindInCells(wind, Heights(wind.cells)))) {
    EXPECT_NEAR(energy, 0.0, 1e-6);
  }
}

TEST(EnergyOfDeformation, IsThatOfShearAndOfStretching) {
  const double length_m = std::cbrt(kDx_m * kDx_m * kDz_m);
  const double unit = std::pow(0.4 * length_m * 0.01, 2);
  const ModelWind shear =
      WindOf([](double, double, double z_m) { return 0.01 * z_m; }, kStill, kStill);
  for (const float energy : EnergyOfDeformation(WindInCells(shear, Heights(shear.cells)))) {
    EXPECT_NEAR(energy / unit, 1.0, 1e-3);
  }
  const ModelWind stretch =
      WindOf(kStill, kStill, [](double, double, double z_m) { return 0.01 * z_m; });
  for (const float energy : EnergyOfDeformation(WindInCells(stretch, Heights(stretch.cells)))) {
    EXPECT_NEAR(energy / unit, 2.0, 2e-3);
  }
}

TEST(EnergyOfDeformation, IsZeroWhereWindIsMissing) {
  ModelWind wind = WindOf([](double, double, double z_m) { return 0.01 * z_m; }, kStill, kStill);
  wind.u_m_per_s[0] = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> energy = EnergyOfDeformation(WindInCells(wind, Heights(wind.cells)));
  EXPECT_EQ(energy[0], 0.0F);
  EXPECT_GT(energy.back(), 0.0F);
}

TEST(LayerMeans, LieBetweenInterfaces) {
  EXPECT_EQ(LayerMeans({1, 2, 3, 6, 5, 4}, 2, 2), (std::vector<float>{2, 4, 4, 5}));
}

TEST(MeanWinds, AreThoseOfEachLevel) {
  const ModelWind wind = WindOf([](double, double, double z_m) { return 0.01 * z_m; },
                                [](double, double, double) { return -3.0; }, kStill);
  const std::vector<glm::dvec2> winds = MeanWinds(wind.u_m_per_s, wind.v_m_per_s, wind.cells.z);
  ASSERT_EQ(winds.size(), 6U);
  EXPECT_NEAR(winds[0].x, 0.5, 1e-6);
  EXPECT_NEAR(winds[5].x, 5.5, 1e-6);
  EXPECT_NEAR(winds[2].y, -3.0, 1e-6);
}

TEST(SteeringWind, IsTheMeanByHeightOfSixKilometres) {
  const std::vector<glm::dvec2> winds = {{10.0, 0.0}, {4.0, 2.0}, {50.0, 50.0}};
  // The mean is over 6 km: 1 km of the first layer, 4 km of the second, and 1 km of the third,
  // which is 8 km thick.
  const glm::dvec2 mean = SteeringWind_m_per_s(winds, {300.0, 1300.0, 5300.0, 13300.0});
  EXPECT_NEAR(mean.x, (10.0 + 16.0 + 50.0) / 6.0, 1e-9);
  EXPECT_NEAR(mean.y, (8.0 + 50.0) / 6.0, 1e-9);
}

TEST(SteeringWind, IsNoneWhereHeightsAreMissingOrItIsNoWind) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(SteeringWind_m_per_s({{10.0, 0.0}}, {nan, nan}), glm::dvec2(0.0));
  EXPECT_EQ(SteeringWind_m_per_s({{1e30, 0.0}}, {0.0, 1000.0}), glm::dvec2(0.0));
  EXPECT_EQ(SteeringWind_m_per_s({{nan, 0.0}}, {0.0, 1000.0}), glm::dvec2(0.0));
}

}  // namespace
}  // namespace thunderhead::storm_files
