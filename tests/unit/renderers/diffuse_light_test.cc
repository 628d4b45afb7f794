// Tests of the diffusion equation on cells, against its closed form in a plane-parallel layer and
// at the extremes.
#include "renderers/light_volume/diffuse_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gtest/gtest.h"

namespace thunderhead::renderers {
namespace {

constexpr int kAcross = 9;
constexpr int kLayers = 20;
constexpr double kLayer_m = 100.0;
constexpr double kAsymmetry = 0.75;

// A layer with an empty cell above and below. Its cells are so wide that no light leaves through
// the sides.
struct Layer {
  DiffusionCells cells;
  double depth = 0.0;

  explicit Layer(double optical_depth, double albedo = 1.0) : depth(optical_depth) {
    cells.size = {kAcross, kAcross, kLayers + 2};
    cells.cell_m = {1e7, 1e7, kLayer_m};
    const double per_m = optical_depth / (kLayers * kLayer_m);
    for (int i = 0; i < kAcross * kAcross * (kLayers + 2); ++i) {
      const int z = i / (kAcross * kAcross);
      const double here = z > 0 && z <= kLayers ? per_m : 0.0;
      cells.light_per_m.push_back(static_cast<float>(here));
      cells.transport_per_m.push_back(static_cast<float>(here * (1.0 - albedo * kAsymmetry)));
      cells.absorption_per_m.push_back(static_cast<float>(here * (1.0 - albedo)));
    }
  }

  std::vector<float> ArrivedRoot(double sine) const {
    std::vector<float> roots(cells.light_per_m.size(), 0.0F);
    for (std::size_t i = 0; i < roots.size(); ++i) {
      const int z = static_cast<int>(i) / (kAcross * kAcross);
      if (z == 0 || z > kLayers) continue;
      roots[i] = static_cast<float>(std::sqrt((kLayers + 0.5 - z) / kLayers * depth / sine));
    }
    return roots;
  }

  static std::size_t Middle(int z) {
    return static_cast<std::size_t>((z * kAcross + kAcross / 2) * kAcross + kAcross / 2);
  }
};

glm::dvec3 Sun(double sine) { return {std::sqrt(1.0 - sine * sine), 0.0, sine}; }

TEST(DiffuseLight, NetFluxIntoALayerIsEddingtons) {
  // The net flux F solves F (4 + 3 T) = 2 m (1 + e) + 3 m^2 (1 - e). Here e = exp(-depth / m), and
  // T is the similarity-scaled depth. This is Eddington's two-stream solution with Marshak's
  // boundary conditions. On these cells it is exact up to single precision and the solver's
  // tolerance.
  for (const double depth : {0.01, 0.1, 1.0, 8.0, 100.0, 1e4}) {
    const Layer layer(depth);
    DiffuseLight light(layer.cells);
    for (const double sine : {1.0, 0.574, 0.0872}) {
      const double passes = std::exp(-depth / sine);
      const double expected = (2.0 * sine * (1.0 + passes) + 3.0 * sine * sine * (1.0 - passes)) /
                              (4.0 + 3.0 * depth * (1.0 - kAsymmetry));
      const auto& net = light.SolveSun(Sun(sine), layer.ArrivedRoot(sine));
      EXPECT_NEAR(net[Layer::Middle(kLayers)] / expected, 1.0, 0.01)
          << "depth " << depth << ", sine " << sine;
    }
  }
}

TEST(DiffuseLight, SkyOverAThickLayerIsReflected) {
  const Layer layer(1000.0);
  const DiffuseLight light(layer.cells);
  const std::size_t top = Layer::Middle(kLayers);
  const glm::vec2 seen = light.SkySeen()[top];
  const glm::vec2 inward = light.SkyInward()[top];
  EXPECT_GT(seen.x + seen.y, 0.99);
  EXPECT_GT(seen.x, 0.99);  // a level top sees irradiance from above
  // The fluence is 1 - K (3 t + 2) at depth t, and 2 K at the bottom, which a black ground does not
  // light.
  EXPECT_NEAR(inward.x + inward.y, 1.0 / (4.0 + 750.0), 1e-4);
}

TEST(DiffuseLight, AbsorptionTakesLight) {
  const Layer white(20.0);
  const Layer grey(20.0, 0.9);
  DiffuseLight in_white(white.cells);
  DiffuseLight in_grey(grey.cells);
  const std::size_t top = Layer::Middle(kLayers);
  EXPECT_GT(in_grey.SolveSun(Sun(1.0), grey.ArrivedRoot(1.0))[top],
            in_white.SolveSun(Sun(1.0), white.ArrivedRoot(1.0))[top]);
}

TEST(DiffuseLight, AWarmStartFindsTheSame) {
  const Layer layer(50.0);
  DiffuseLight cold(layer.cells);
  DiffuseLight warm(layer.cells);
  (void)warm.SolveSun(Sun(0.3), layer.ArrivedRoot(0.3));
  const std::size_t middle = Layer::Middle(kLayers / 2);
  const float from_warm = warm.SolveSun(Sun(0.8), layer.ArrivedRoot(0.8))[middle];
  EXPECT_NEAR(cold.SolveSun(Sun(0.8), layer.ArrivedRoot(0.8))[middle] / from_warm, 1.0, 0.01);
}

// Returns a medium of 40 by 41 by 20 cells: dense cloud cores in thin haze.
DiffusionCells HazeAndCores(bool mirrored) {
  DiffusionCells cells;
  cells.size = {40, 41, 20};
  cells.cell_m = {1000.0, 1000.0, 400.0};
  for (int z = 0; z < cells.size.z; ++z) {
    for (int row = 0; row < cells.size.y; ++row) {
      const int y = mirrored ? cells.size.y - 1 - row : row;
      for (int x = 0; x < cells.size.x; ++x) {
        const double wave = std::sin(0.4 * x) * std::sin(0.3 * y + 0.1 * x) + 0.5 * std::cos(z);
        const auto per_m = static_cast<float>(1e-5 * std::exp(4.0 * wave));
        cells.light_per_m.push_back(per_m);
        cells.transport_per_m.push_back(0.25F * per_m);
        cells.absorption_per_m.push_back(0.0F);
      }
    }
  }
  return cells;
}

// The test moves the sun in small steps, as a drag does. Each solution starts from the previous one
// with a loose tolerance, and the errors must not accumulate.
TEST(DiffuseLight, LooseSolutionsStayNearTheConvergedOne) {
  DiffuseLight loose(HazeAndCores(false));
  DiffuseLight exact(HazeAndCores(false));
  double largest = 0.0;
  double worst = 0.0;
  int iterations = 0;
  int exact_iterations = 0;
  for (double sine = 0.3; sine < 0.9; sine += 0.04) {
    const std::vector<float> roots(loose.ExitRoot().size(),
                                   static_cast<float>(0.5 / std::sqrt(sine)));
    const std::vector<float> near = loose.SolveSun(Sun(sine), roots, 4e-3);
    iterations += loose.LastIterations();
    const std::vector<float> converged = exact.SolveSun(Sun(sine), roots, 1e-6);
    exact_iterations += exact.LastIterations();
    for (std::size_t i = 0; i < near.size(); ++i) {
      largest = std::max(largest, static_cast<double>(std::abs(converged[i])));
      worst = std::max(worst, static_cast<double>(std::abs(near[i] - converged[i])));
    }
  }
  EXPECT_LT(worst, 0.01 * largest);
  EXPECT_LT(2 * iterations, exact_iterations);
}

// Returns the number of solver iterations for a sun that moves by these azimuth steps, with a loose
// tolerance. The first three solutions do not count.
int IterationsFor(const std::vector<double>& steps_rad) {
  DiffuseLight light(HazeAndCores(false));
  int iterations = 0;
  double azimuth_rad = 0.0;
  for (std::size_t i = 0; i < steps_rad.size(); ++i) {
    azimuth_rad += steps_rad[i];
    // The depth of the exit root varies across the medium and with the sun.
    std::vector<float> roots(light.ExitRoot().size());
    for (std::size_t cell = 0; cell < roots.size(); ++cell) {
      const double x = static_cast<double>(cell % 40) / 40.0;
      roots[cell] = static_cast<float>(0.8 + 0.4 * std::sin(6.0 * x + 3.0 * azimuth_rad));
    }
    (void)light.SolveSun({0.8 * std::cos(azimuth_rad), 0.8 * std::sin(azimuth_rad), 0.6}, roots,
                         4e-3);
    if (i >= 3) iterations += light.LastIterations();
  }
  return iterations;
}

TEST(DiffuseLight, ASunThatGoesOnIsFollowed) {
  const std::vector<double> on(15, 0.04);
  std::vector<double> to_and_fro;
  for (std::size_t i = 0; i < on.size(); ++i) to_and_fro.push_back(i % 2 == 0 ? 0.04 : -0.04);
  EXPECT_LT(IterationsFor(on), 0.8 * IterationsFor(to_and_fro));
}

// The solver divides the medium into many blocks of columns. In the mirrored medium the blocks
// begin at other places.
TEST(DiffuseLight, OfAMirroredMediumIsTheMirroredLight) {
  const glm::ivec3 size(40, 41, 20);
  const std::vector<float> roots(static_cast<std::size_t>(size.x * size.y * size.z), 0.7F);
  DiffuseLight light(HazeAndCores(false));
  DiffuseLight mirrored(HazeAndCores(true));
  const std::vector<float>& net = light.SolveSun({0.6, 0.3, 0.74}, roots);
  const std::vector<float>& net_mirrored = mirrored.SolveSun({0.6, -0.3, 0.74}, roots);
  double largest = 0.0;
  double off = 0.0;
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        const auto at = [&](int row) {
          return static_cast<std::size_t>((z * size.y + row) * size.x + x);
        };
        largest = std::max(largest, std::abs(double{net[at(y)]}));
        off = std::max(off, std::abs(double{net[at(y)]} - net_mirrored[at(size.y - 1 - y)]));
      }
    }
  }
  EXPECT_LT(off, 1e-3 * largest);
  // If the blocks divided columns, the solver would need five times as many iterations.
  EXPECT_LT(light.LastIterations(), 40);
}

TEST(DiffuseLight, NothingBreaks) {
  for (const double depth : {0.0, 1e-8, 1e-2, 1e8}) {
    for (const double sine : {-0.1, 0.0, 1e-4, 1.0}) {
      SCOPED_TRACE(testing::Message() << "depth " << depth << ", sine " << sine);
      const Layer layer(depth);
      DiffuseLight light(layer.cells);
      const auto& net = light.SolveSun(Sun(sine), layer.ArrivedRoot(std::max(sine, 1e-4)));
      const std::size_t cells = layer.cells.light_per_m.size();
      ASSERT_EQ(net.size(), cells);
      ASSERT_EQ(light.SkyInward().size(), cells);
      ASSERT_EQ(light.FromWalls().size(), cells);
      float sun = 0.0F;
      float sky = 0.0F;
      for (std::size_t i = 0; i < cells; ++i) {
        const glm::vec2& inward = light.SkyInward()[i];
        ASSERT_TRUE(std::isfinite(net[i]));
        ASSERT_TRUE(std::isfinite(inward.x) && std::isfinite(inward.y));
        ASSERT_TRUE(std::isfinite(light.FromWalls()[i]));
        sun = std::max(sun, net[i]);
        sky = std::max(sky, std::abs(inward.x) + std::abs(inward.y));
      }
      // A depth of 1e-8 scatters less light than single precision can represent.
      const bool scatters = depth > 1e-8;
      EXPECT_EQ(sky > 0.0F, scatters) << sky;
      if (scatters && sine > 0.0) {
        EXPECT_GT(sun, 0.0F);
      }
    }
  }
}

}  // namespace
}  // namespace thunderhead::renderers
