#include "clouds/rbf_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "clouds/basis_operator.h"
#include "clouds/clustering.h"
#include "clouds/output_weights.h"
#include "glm/geometric.hpp"
#include "physics/counter_random.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::clouds {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

volume::RegularGrid Grid() { return {{23, 18, 15}, {40.0, 50.0, 30.0}, {-460.0, -450.0, 600.0}}; }

// Returns random balls, some of which extend beyond the grid.
std::vector<Metaball> SomeBalls(int count) {
  std::vector<Metaball> balls;
  physics::CounterRandom random(3, 0);
  for (int i = 0; i < count; ++i) {
    Metaball ball;
    ball.centre_m = {-480.0 + 960.0 * random.Next(), -460.0 + 920.0 * random.Next(),
                     590.0 + 470.0 * random.Next()};
    ball.sigma_m = 30.0 + 60.0 * random.Next();
    ball.weight = 0.5 + random.Next();
    balls.push_back(ball);
  }
  return balls;
}

std::vector<double> WeightsOf(const std::vector<Metaball>& balls) {
  std::vector<double> weights;
  for (const Metaball& ball : balls) weights.push_back(ball.weight);
  return weights;
}

// Returns the sum of all balls at a point (eq. 19 of P. Man, cited in clouds/metaballs.h).
double ValueAt(const MetaballCloud& cloud, const glm::dvec3& point_m) {
  double sum = 0.0;
  for (const Metaball& ball : cloud.balls) {
    const double distance_m = glm::length(point_m - ball.centre_m);
    sum += ball.weight * BasisValue(cloud.basis, cloud.overlap, ball.sigma_m, distance_m);
  }
  return sum;
}

glm::dvec3 MiddleOf_m(const volume::RegularGrid& grid, int x, int y, int z) {
  return grid.low_corner_m + (glm::dvec3(x, y, z) + 0.5) * grid.spacing_m;
}

// Returns a lumpy cloud with holes.
std::vector<float> Cloud(const volume::RegularGrid& grid) {
  std::vector<float> values;
  for (int z = 0; z < grid.cells.z; ++z) {
    for (int y = 0; y < grid.cells.y; ++y) {
      for (int x = 0; x < grid.cells.x; ++x) {
        const glm::dvec3 p = MiddleOf_m(grid, x, y, z) - glm::dvec3(0.0, 0.0, 825.0);
        const double inside = 1.0 - glm::dot(p, p) / (350.0 * 350.0);
        const double lumps = std::sin(p.x / 45.0) * std::sin(p.y / 60.0) + std::cos(p.z / 50.0);
        values.push_back(static_cast<float>(std::max(0.0, inside * (0.6 + 0.4 * lumps))));
      }
    }
  }
  return values;
}

TEST(BasisValue, IsThePrintedGaussianAndWyvillsField) {
  EXPECT_NEAR(BasisValue(Basis::kGaussian, 2.0, 50.0, 50.0), std::exp(-1.0), 1e-15);
  EXPECT_EQ(BasisValue(Basis::kGaussian, 2.0, 50.0, 150.0), 0.0);
  EXPECT_EQ(BasisValue(Basis::kWyvill, 2.0, 50.0, 0.0), 1.0);
  EXPECT_EQ(BasisValue(Basis::kWyvill, 2.0, 50.0, 100.0), 0.0);
  EXPECT_NEAR(BasisValue(Basis::kWyvill, 2.0, 50.0, 99.999), 0.0, 1e-6);
  EXPECT_NEAR(BasisValue(Basis::kWyvill, 2.0, 50.0, 50.0), 0.5, 1e-15);
}

TEST(BasisOperator, IsTheSumOfBallsInEveryCell) {
  for (const Basis basis : {Basis::kGaussian, Basis::kWyvill}) {
    MetaballCloud cloud;
    cloud.basis = basis;
    cloud.balls = SomeBalls(40);
    const volume::RegularGrid grid = Grid();
    std::vector<float> field;
    BasisOperator(grid, cloud.balls, basis, cloud.overlap, 2).Apply(WeightsOf(cloud.balls), &field);
    for (int z = 0; z < grid.cells.z; ++z) {
      for (int y = 0; y < grid.cells.y; ++y) {
        for (int x = 0; x < grid.cells.x; ++x) {
          // At the cut-off a ball's value is 1.2e-4. Rounding may put a cell on either side of it.
          EXPECT_NEAR(field[grid.Offset(x, y, z)], ValueAt(cloud, MiddleOf_m(grid, x, y, z)), 2e-6);
        }
      }
    }
  }
}

// Checks that <A v, f> = <v, A^T f>, and that the operator's column norms are the norms of single
// balls.
TEST(BasisOperator, TransposeIsTheAdjoint) {
  const std::vector<Metaball> balls = SomeBalls(30);
  const std::vector<float> field = Cloud(Grid());
  for (const Basis basis : {Basis::kGaussian, Basis::kWyvill}) {
    const BasisOperator map(Grid(), balls, basis, 2.5, 3);
    std::vector<float> image;
    std::vector<double> sums;
    map.Apply(WeightsOf(balls), &image);
    map.ApplyTransposed(field, &sums);
    double left = 0.0;
    double right = 0.0;
    for (std::size_t i = 0; i < field.size(); ++i) left += static_cast<double>(image[i]) * field[i];
    for (std::size_t k = 0; k < balls.size(); ++k) right += balls[k].weight * sums[k];
    EXPECT_NEAR(left, right, 1e-5 * std::abs(left));
    const std::vector<double> norms = map.SquaredNorms();
    std::vector<double> one(balls.size(), 0.0);
    one[7] = 1.0;
    map.Apply(one, &image);
    double norm = 0.0;
    for (const float value : image) norm += static_cast<double>(value) * value;
    EXPECT_NEAR(norms[7], norm, 1e-5 * norm);
  }
}

TEST(OutputWeights, BothSolversFindTheWeightsThatMadeTheField) {
  const std::vector<Metaball> balls = SomeBalls(25);
  const BasisOperator map(Grid(), balls, Basis::kGaussian, 2.0, 2);
  std::vector<float> field;
  map.Apply(WeightsOf(balls), &field);
  const auto go_on = [](int, double) { return true; };
  for (const bool non_negative : {false, true}) {
    WeightOptions options{non_negative, 3000, 0.0};
    const OutputWeights direct = ByLeastSquares(map, field, options, go_on);
    const OutputWeights gradient = ByGradient(map, field, options, go_on);
    for (std::size_t k = 0; k < balls.size(); ++k) {
      EXPECT_NEAR(direct.weights[k], balls[k].weight, 1e-3);
      EXPECT_NEAR(gradient.weights[k], balls[k].weight, 2e-2);
    }
    EXPECT_LT(direct.errors.back(), 1e-8 * direct.errors.front());
    EXPECT_TRUE(std::ranges::is_sorted(gradient.errors, [](double a, double b) {
      return a > b * (1.0 + 1e-6) + 1e-9;  // tolerance for the rounding of float fields
    }));
  }
}

TEST(OutputWeights, NonNegativeOnesStaySo) {
  const std::vector<Metaball> balls = SomeBalls(60);
  const BasisOperator map(Grid(), balls, Basis::kGaussian, 3.0, 2);
  const std::vector<float> field = Cloud(Grid());
  const auto go_on = [](int, double) { return true; };
  const OutputWeights free = ByLeastSquares(map, field, {false, 300, 1e-6}, go_on);
  const OutputWeights bound = ByLeastSquares(map, field, {true, 300, 1e-6}, go_on);
  EXPECT_LT(*std::ranges::min_element(free.weights), 0.0);
  EXPECT_GE(*std::ranges::min_element(bound.weights), 0.0);
  EXPECT_LE(free.errors.back(), bound.errors.back());
  EXPECT_LT(bound.errors.back(), 0.7 * bound.errors.front());
}

std::vector<glm::vec3> RandomPoints(int count) {
  std::vector<glm::vec3> points;
  physics::CounterRandom random(9, 1);
  for (int i = 0; i < count; ++i) {
    points.emplace_back(1000.0 * random.Next(), 500.0 * random.Next(), 200.0 * random.Next());
  }
  return points;
}

TEST(Cluster, SigmasAreRootMeanSquareDistancesOfTheNearestPoints) {
  const std::vector<glm::vec3> points = RandomPoints(5000);
  ClusteringOptions options;
  options.centres = 60;
  options.threads = 2;
  const Clusters clusters = Cluster(points, 1.0, options, {}, {});
  ASSERT_EQ(clusters.centres_m.size(), 60U);
  std::vector<double> squares(60, 0.0);
  std::vector<int> counts(60, 0);
  for (const glm::vec3& point : points) {
    std::size_t nearest = 0;
    double best = 1e30;
    for (std::size_t k = 0; k < 60; ++k) {
      const double away = glm::length(clusters.centres_m[k] - glm::dvec3(point));
      if (away < best) {
        best = away;
        nearest = k;
      }
    }
    squares[nearest] += best * best;
    ++counts[nearest];
  }
  double within = 0.0;
  for (std::size_t k = 0; k < 60; ++k) {
    const double sigma = counts[k] > 0 ? std::sqrt(squares[k] / counts[k]) : 0.0;
    EXPECT_NEAR(clusters.sigmas_m[k], std::max(sigma, 1.0), 1e-6);
    within += squares[k];
  }
  // Cubes of a 60th of the volume have a mean square distance of a quarter of their edge's square.
  // No clustering does better, and k-means comes within 40 % of it.
  const double edge = std::cbrt(1000.0 * 500.0 * 200.0 / 60.0);
  EXPECT_LT(within / 5000.0, 1.4 * 0.25 * edge * edge);
}

TEST(Cluster, IsTheSameForAnyNumberOfThreads) {
  const std::vector<glm::vec3> points = RandomPoints(3000);
  ClusteringOptions options;
  options.centres = 200;
  const Clusters one = Cluster(points, 1.0, options, {}, {});
  options.threads = 4;
  const Clusters four = Cluster(points, 1.0, options, {}, {});
  EXPECT_EQ(one.centres_m, four.centres_m);
  EXPECT_EQ(one.sigmas_m, four.sigmas_m);
}

TEST(Fit, ErrorIsThatOfTheBallsAndFallsAsTheirNumberGrows) {
  const volume::RegularGrid grid = Grid();
  const std::vector<float> values = Cloud(grid);
  double before = 1.0;
  for (const int balls : {4, 30, 300}) {
    FitOptions options;
    options.balls = balls;
    const auto fit = Fit(grid, values, options, {}, {});
    ASSERT_TRUE(fit.ok()) << fit.status();
    double error = 0.0;
    double squares = 0.0;
    for (int z = 0; z < grid.cells.z; ++z) {
      for (int y = 0; y < grid.cells.y; ++y) {
        for (int x = 0; x < grid.cells.x; ++x) {
          const glm::dvec3 p = MiddleOf_m(grid, x, y, z);
          const bool in_box = glm::all(glm::greaterThan(p, fit->cloud.low_m)) &&
                              glm::all(glm::lessThan(p, fit->cloud.high_m));
          const double value = values[grid.Offset(x, y, z)];
          squares += value * value;
          if (in_box) error += std::pow(value - ValueAt(fit->cloud, p), 2.0);
        }
      }
    }
    EXPECT_NEAR(fit->error, error, 1e-4 * error);
    EXPECT_NEAR(fit->relative_error, std::sqrt(error / squares), 1e-3);
    EXPECT_LT(fit->relative_error, 0.75 * before);
    before = fit->relative_error;
  }
}

TEST(Fit, IsTheSameForAnyNumberOfThreads) {
  FitOptions options;
  options.balls = 50;
  options.threads = 1;
  const auto one = Fit(Grid(), Cloud(Grid()), options, {}, {});
  options.threads = 3;
  const auto three = Fit(Grid(), Cloud(Grid()), options, {}, {});
  EXPECT_EQ(one->cloud, three->cloud);
}

TEST(Fit, RefusesWhatCannotBe) {
  const volume::RegularGrid grid = Grid();
  std::vector<float> values(grid.CellCount(), 0.0F);
  FitOptions options;
  options.balls = 2;
  const auto message = [&] {
    const auto fit = Fit(grid, values, options, {}, {});
    EXPECT_EQ(fit.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(fit.status().message());
  };
  EXPECT_THAT(message(), HasSubstr("empty"));
  values[grid.Offset(3, 4, 5)] = 1.0F;
  EXPECT_THAT(message(), HasSubstr("more than the 1 cells"));
  options.balls = 0;
  EXPECT_THAT(message(), HasSubstr("balls"));
  options.balls = 1;
  options.overlap = 0.0;
  EXPECT_THAT(message(), HasSubstr("overlap"));
  // With one ball for one cell, the ball fits that cell.
  options.overlap = 2.0;
  const auto fit = Fit(grid, values, options, {}, {});
  ASSERT_TRUE(fit.ok()) << fit.status();
  EXPECT_NEAR(glm::length(fit->cloud.balls[0].centre_m - MiddleOf_m(grid, 3, 4, 5)), 0.0, 1e-3);
}

TEST(Fit, StopsWhenAsked) {
  std::stop_source stop;
  FitOptions options;
  options.balls = 20;
  options.min_gain = 0.0;
  const auto fit = Fit(
      Grid(), Cloud(Grid()), options,
      [&](const FitProgress& progress) {
        if (progress.phase == "weights") stop.request_stop();
      },
      stop.get_token());
  ASSERT_TRUE(fit.ok());
  EXPECT_EQ(fit->errors.size(), 2U);
  EXPECT_EQ(Fit(Grid(), Cloud(Grid()), options, {}, stop.get_token()).status().code(),
            absl::StatusCode::kCancelled);
}

TEST(Metaballs, AreSavedAsTextWithoutLoss) {
  const testing::TemporaryFolder folder;
  MetaballCloud cloud;
  cloud.quantity = "cloud";
  cloud.units = "kg/m3";
  cloud.basis = Basis::kWyvill;
  cloud.overlap = 1.0 / 3.0;
  cloud.low_m = {-1e5 / 7.0, 0.0, 1e-9};
  cloud.high_m = {1.0, 2.0, 3.0};
  cloud.balls = SomeBalls(17);
  cloud.balls[3].weight = -1e-300;
  ASSERT_TRUE(SaveBalls(cloud, folder.File("a.balls")).ok());
  std::ifstream file(folder.File("a.balls"));
  std::string line;
  const auto next = [&] {
    EXPECT_TRUE(std::getline(file, line));
    return line;
  };
  // Returns the numbers of the next line, which begins with `word`.
  const auto numbers = [&](const std::string& word) {
    std::istringstream words(next());
    std::string first;
    words >> first;
    EXPECT_EQ(first, word);
    std::vector<double> values;
    // The operator >> would refuse denormal numbers.
    for (std::string number; words >> number;)
      values.push_back(std::strtod(number.c_str(), nullptr));
    return values;
  };
  EXPECT_EQ(next(), "thunderhead balls 1");
  EXPECT_EQ(next(), "quantity cloud kg/m3");
  EXPECT_EQ(next(), "basis wyvill");
  EXPECT_THAT(numbers("overlap"), ElementsAre(cloud.overlap));
  EXPECT_THAT(numbers("low_m"), ElementsAre(cloud.low_m.x, cloud.low_m.y, cloud.low_m.z));
  EXPECT_THAT(numbers("high_m"), ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(numbers("balls"), ElementsAre(17.0));
  for (const Metaball& ball : cloud.balls) {
    EXPECT_THAT(numbers("ball"), ElementsAre(ball.centre_m.x, ball.centre_m.y, ball.centre_m.z,
                                             ball.sigma_m, ball.weight));
  }
  EXPECT_FALSE(std::getline(file, line));
  EXPECT_FALSE(SaveBalls(cloud, folder.File("none/a.balls")).ok());
}

}  // namespace
}  // namespace thunderhead::clouds
