#include "storm_files/vertical_remap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <utility>

namespace thunderhead::storm_files {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::FloatEq;
using ::testing::FloatNear;

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

double Path(const std::vector<float>& interfaces_m, const std::vector<float>& concentration) {
  double path = 0.0;
  for (std::size_t i = 0; i < concentration.size(); ++i) {
    path += static_cast<double>(concentration[i]) * (interfaces_m[i + 1] - interfaces_m[i]);
  }
  return path;
}

double Path(const VerticalGrid& grid, const std::vector<float>& cells) {
  double path = 0.0;
  for (const float cell : cells) path += cell * grid.spacing_m;
  return path;
}

// Layer 1 (100 to 300 m) has the central slope (4 - 1) / (450 - 50) = 0.0075 per m. That is below
// the limit 2 * 1 / 200 = 0.01. The outer layers are flat. Cell 0 contains 100 * 1 from layer 0 and
// 50 * (2 + 0.0075 * (125 - 200)) = 71.875 from layer 1. Cell 1 contains 150 * (2 + 0.0075 * 25) =
// 328.125.
TEST(VerticalRemap, AgreesWithAColumnComputedByHand) {
  const VerticalGrid grid{0.0, 150.0, 4};
  EXPECT_THAT(RemapColumns({0, 100, 300, 600}, {1, 2, 4}, 3, 1, grid),
              ElementsAre(FloatNear(171.875F / 150, 1e-6F), FloatNear(328.125F / 150, 1e-6F),
                          FloatEq(4), FloatEq(4)));
}

// With the neighbours 1 and 100, the smaller step limits the slope: 2 * 1 / 100 per m. The top half
// of the middle layer therefore has 2 + 0.02 * 25 = 2.5, and the lower half 1.5. Neither leaves the
// range of its neighbours.
TEST(VerticalRemap, LimitsTheSlopeSoThatNoNewExtremeAppears) {
  const VerticalGrid grid{0.0, 50.0, 6};
  EXPECT_THAT(RemapColumns({0, 100, 200, 300}, {1, 2, 100}, 3, 1, grid),
              ElementsAre(1, 1, FloatNear(1.5F, 1e-6F), FloatNear(2.5F, 1e-6F), 100, 100));
}

TEST(VerticalRemap, KeepsLayersThatAreCells) {
  const VerticalGrid grid{200.0, 100.0, 4};
  EXPECT_THAT(RemapColumns({200, 300, 400, 500, 600}, {5, 1, 7, 2}, 4, 1, grid),
              ElementsAre(FloatEq(5), FloatEq(1), FloatEq(7), FloatEq(2)));
}

TEST(VerticalRemap, PreservesThePathOfRandomColumnsAndStaysWithinTheirRange) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> thickness_m(5.0F, 700.0F);
  std::uniform_real_distribution<float> mass(0.0F, 1e-2F);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<float> interfaces_m = {thickness_m(random)};
    std::vector<float> concentration;
    for (int level = 0; level < 40; ++level) {
      interfaces_m.push_back(interfaces_m.back() + thickness_m(random));
      concentration.push_back(trial % 3 == 0 && level % 4 != 0 ? 0.0F : mass(random));
    }
    const VerticalGrid grid = ChooseVerticalGrid(interfaces_m, 40, 1);
    ASSERT_GT(grid.cells, 0);
    const std::vector<float> cells = RemapColumns(interfaces_m, concentration, 40, 1, grid);
    // The tolerance covers sums of some hundred terms in single precision.
    EXPECT_NEAR(Path(grid, cells) / Path(interfaces_m, concentration), 1.0, 1e-5);
    const float largest = *std::max_element(concentration.begin(), concentration.end());
    EXPECT_THAT(cells, Each(::testing::AllOf(::testing::Ge(0.0F),
                                             ::testing::Le(largest * (1.0F + 1e-5F)))));
  }
}

TEST(VerticalRemap, SkipsLayersThatAreMissingOrUpsideDown) {
  const VerticalGrid grid{0.0, 100.0, 4};
  EXPECT_THAT(RemapColumns({0, 100, kMissing, 300, 400}, {1, 2, 3, 4}, 4, 1, grid),
              ElementsAre(1, 0, 0, 4));
  EXPECT_THAT(RemapColumns({0, 200, 100, 300, 400}, {1, 2, 0, 4}, 4, 1, grid),
              ElementsAre(1, 1, 0, 4));
}

TEST(VerticalRemap, PutsWhatLiesOutsideTheGridIntoItsEndCells) {
  const VerticalGrid grid{100.0, 100.0, 2};
  EXPECT_THAT(RemapColumns({0, 100, 200, 300, 400}, {1, 2, 3, 4}, 4, 1, grid),
              ElementsAre(FloatNear(3, 1e-6F), FloatNear(7, 1e-6F)));
}

// 20 columns are more than one block and less than two. The mass identifies each column.
TEST(VerticalRemap, KeepsColumnsApart) {
  constexpr int kColumns = 20;
  std::vector<float> interfaces_m(3 * kColumns);
  std::vector<float> concentration(2 * kColumns, 0.0F);
  for (int column = 0; column < kColumns; ++column) {
    for (int k = 0; k < 3; ++k) interfaces_m[k * kColumns + column] = 50.0F * k;
    concentration[kColumns + column] = static_cast<float>(column);
  }
  const std::vector<float> cells =
      RemapColumns(interfaces_m, concentration, 2, kColumns, {0.0, 50.0, 3});
  ASSERT_EQ(cells.size(), 3U * kColumns);
  for (int column = 0; column < kColumns; ++column) {
    EXPECT_EQ(cells[column], 0.0F);
    EXPECT_FLOAT_EQ(cells[kColumns + column], static_cast<float>(column));
    EXPECT_EQ(cells[2 * kColumns + column], 0.0F);
  }
}

// Eight layers of 100 m need 8.04 cells with the space above, so there are nine.
TEST(ChooseVerticalGrid, IsAsFineAsEqualLayersWithRoomAbove) {
  std::vector<float> interfaces_m;
  for (int k = 0; k <= 8; ++k) interfaces_m.push_back(100.0F * k + 30.0F);
  const VerticalGrid grid = ChooseVerticalGrid(interfaces_m, 8, 1);
  EXPECT_DOUBLE_EQ(grid.low_m, 30.0);
  EXPECT_DOUBLE_EQ(grid.spacing_m, 100.0);
  EXPECT_EQ(grid.cells, 9);
}

TEST(ChooseVerticalGrid, HasAtMostAQuarterMoreCellsThanLevels) {
  // Layers are from 10 m to 1.3 km thick, as over land. The thinnest would require 1,000 cells.
  std::vector<float> interfaces_m = {0.0F};
  for (int k = 0; k < 40; ++k) {
    interfaces_m.push_back(interfaces_m.back() + 10.0F * std::pow(1.13F, static_cast<float>(k)));
  }
  const VerticalGrid grid = ChooseVerticalGrid(interfaces_m, 40, 1);
  EXPECT_LE(grid.cells, 50);
  EXPECT_GE(grid.cells, 49);
  EXPECT_GE(grid.High_m(), interfaces_m.back());
}

// Returns the height above which the share `share` of a column's mass lies. `faces_m` has one value
// more than `concentration`, which is the same all over a cell.
double HeightBelow_m(const std::vector<float>& faces_m, const std::vector<float>& concentration,
                     double share) {
  double above = 0.0;
  const double wanted = share * Path(faces_m, concentration);
  for (std::size_t i = concentration.size(); i-- > 0;) {
    const double mass = static_cast<double>(concentration[i]) * (faces_m[i + 1] - faces_m[i]);
    if (above + mass >= wanted && mass > 0.0) {
      return faces_m[i + 1] - (wanted - above) / concentration[i];
    }
    above += mass;
  }
  return 0.0;
}

// The heights of interfaces in m, upwards, and the greatest thickness of a cell of their grid.
struct LayersOfModel {
  const char* name;
  std::vector<float> interfaces_m;
  double thickest_cell_m;
};

// The 137 levels of IFS in the standard atmosphere: heights of some interfaces, with even layers
// between them. The lowest layers are 23 m thick and the highest one 4.5 km.
LayersOfModel Ifs137() {
  const std::vector<std::pair<int, double>> known = {
      {0, 0.0},       {4, 92.0},      {10, 310.0},    {18, 842.0},
      {26, 1828.0},   {40, 5035.0},   {60, 10844.0},  {80, 17127.0},
      {95, 23078.0},  {105, 28713.0}, {115, 36788.0}, {122, 44989.0},
      {128, 54965.0}, {132, 64104.0}, {135, 72988.0}, {137, 81935.0}};
  LayersOfModel layers{"137 levels of IFS", {0.0F}, 177.0};
  for (std::size_t i = 1; i < known.size(); ++i) {
    const auto [from, from_m] = known[i - 1];
    const auto [to, to_m] = known[i];
    for (int k = from + 1; k <= to; ++k) {
      layers.interfaces_m.push_back(
          static_cast<float>(from_m + (to_m - from_m) * (k - from) / (to - from)));
    }
  }
  return layers;
}

// Layers of 10 m up to 300 m, and of 500 m up to 20 km.
LayersOfModel ThinNearTheGround() {
  LayersOfModel layers{"10 m near the ground", {0.0F}, 236.0};
  while (layers.interfaces_m.back() < 20'000.0F) {
    layers.interfaces_m.push_back(layers.interfaces_m.back() +
                                  (layers.interfaces_m.back() < 300.0F ? 10.0F : 500.0F));
  }
  return layers;
}

LayersOfModel UpperOnly() {
  LayersOfModel layers{"upper levels only", {5035.0F}, 291.0};
  for (const float each_m : Ifs137().interfaces_m) {
    if (each_m > 5036.0F && each_m < 20'000.0F) layers.interfaces_m.push_back(each_m);
  }
  return layers;
}

// A column keeps its mass, and a cloud its heights, however uneven the layers are.
TEST(ChooseVerticalGrid, KeepsMassAndTopOfClouds) {
  for (const LayersOfModel& model : {Ifs137(), ThinNearTheGround(), UpperOnly()}) {
    SCOPED_TRACE(model.name);
    const auto levels = static_cast<int>(model.interfaces_m.size()) - 1;
    const VerticalGrid grid = ChooseVerticalGrid(model.interfaces_m, levels, 1);
    EXPECT_LE(grid.spacing_m, model.thickest_cell_m);
    std::vector<float> faces_m;
    for (int i = 0; i <= grid.cells; ++i) {
      faces_m.push_back(static_cast<float>(grid.low_m + i * grid.spacing_m));
    }
    for (const auto& [base_m, top_m] : {std::pair{0.0F, 12'000.0F},
                                        {5100.0F, 12'000.0F},
                                        {9000.0F, 11'000.0F},
                                        {0.0F, 1500.0F}}) {
      SCOPED_TRACE(top_m);
      std::vector<float> cloud;
      for (int i = 0; i < levels; ++i) {
        const float middle_m = 0.5F * (model.interfaces_m[i] + model.interfaces_m[i + 1]);
        cloud.push_back(middle_m > base_m && middle_m < top_m ? 1e-3F : 0.0F);
      }
      const double path = Path(model.interfaces_m, cloud);
      if (path == 0.0) continue;
      const std::vector<float> cells = RemapColumns(model.interfaces_m, cloud, levels, 1, grid);
      EXPECT_NEAR(Path(grid, cells) / path, 1.0, 1e-5);
      const double middle_m = HeightBelow_m(model.interfaces_m, cloud, 0.5);
      EXPECT_NEAR(HeightBelow_m(faces_m, cells, 0.5), middle_m, 0.01 * middle_m);
      // The top is known to a cell, and that of a tall cloud to 1 %.
      const double highest_m = HeightBelow_m(model.interfaces_m, cloud, 0.01);
      const double tolerance_m = top_m - base_m > 6000.0F ? 0.01 * highest_m : grid.spacing_m;
      EXPECT_NEAR(HeightBelow_m(faces_m, cells, 0.01), highest_m, tolerance_m);
    }
  }
}

// The highest cell has the mass above 30 km, so no mass is lost.
TEST(ChooseVerticalGrid, EndsAboveAllClouds) {
  const std::vector<float> interfaces_m = Ifs137().interfaces_m;
  const VerticalGrid grid = ChooseVerticalGrid(interfaces_m, 137, 1);
  EXPECT_NEAR(grid.High_m(), 30'000.0, 200.0);
  std::vector<float> cloud(137, 0.0F);
  cloud[40] = 1e-4F;
  cloud[130] = 1e-6F;
  const std::vector<float> cells = RemapColumns(interfaces_m, cloud, 137, 1, grid);
  EXPECT_NEAR(Path(grid, cells) / Path(interfaces_m, cloud), 1.0, 1e-5);
  EXPECT_GT(cells.back(), 0.0F);
  EXPECT_EQ(Extended(grid, interfaces_m).cells, grid.cells);
  // The grid covers all layers if the fields hold extinction, which may lie at any height. It also
  // covers them if they begin so high that they cannot be those of a storm.
  constexpr double kAnyHeight = std::numeric_limits<double>::infinity();
  EXPECT_GE(ChooseVerticalGrid(interfaces_m, 137, 1, kAnyHeight).High_m(), 81'935.0);
  EXPECT_GE(ChooseVerticalGrid({20'000.0F, 30'000.0F, 50'000.0F}, 2, 1).High_m(), 50'000.0);
}

TEST(ChooseVerticalGrid, HasOneCellForOneLayerAndNoneForNone) {
  const VerticalGrid one = ChooseVerticalGrid({500, 900}, 1, 1);
  EXPECT_EQ(one.cells, 1);
  EXPECT_DOUBLE_EQ(one.low_m, 500.0);
  EXPECT_DOUBLE_EQ(one.spacing_m, 400.0);
  EXPECT_EQ(ChooseVerticalGrid({kMissing, 900}, 1, 1).cells, 0);
  EXPECT_EQ(ChooseVerticalGrid({900, 500}, 1, 1).cells, 0);
}

TEST(ExtendedGrid, AddsWholeCellsBelowAndAbove) {
  const VerticalGrid grid{0.0, 100.0, 10};
  const VerticalGrid same = Extended(grid, {0, 999});
  EXPECT_EQ(same.cells, 10);
  const VerticalGrid more = Extended(grid, {-150, 1010});
  EXPECT_DOUBLE_EQ(more.low_m, -200.0);
  EXPECT_EQ(more.cells, 13);
  EXPECT_DOUBLE_EQ(more.High_m(), 1100.0);
  // More cells than an int can count are still more cells.
  EXPECT_GE(Extended({0.0, 1e-6, 10}, {-9e5F, 9e5F}).cells, 100'000'000);
}

}  // namespace
}  // namespace thunderhead::storm_files
