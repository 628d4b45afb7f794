#include "clouds/rbf_fit.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <thread>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "clouds/basis_operator.h"
#include "clouds/clustering.h"
#include "clouds/output_weights.h"
#include "glm/common.hpp"

namespace thunderhead::clouds {
namespace {

// The width, in cells, of a margin of empty cells around the cloud. The margin is part of the
// fitted box, so that balls do not spread into clear air.
constexpr int kBorderCells = 2;

struct Training {
  volume::RegularGrid grid;         // the box
  std::vector<float> values;        // y of eq. 20, for each cell of the box
  std::vector<glm::vec3> points_m;  // centres of the cells above 0, from the box's middle
  glm::dvec3 middle_m{0.0};
};

bool FindBox(const volume::RegularGrid& grid, const std::vector<float>& values,
             volume::CellBox* box) {
  *box = {grid.cells, glm::ivec3(0)};
  std::size_t at = 0;
  for (int z = 0; z < grid.cells.z; ++z) {
    for (int y = 0; y < grid.cells.y; ++y) {
      for (int x = 0; x < grid.cells.x; ++x, ++at) {
        if (!(values[at] > 0.0F)) continue;
        box->low = glm::min(box->low, glm::ivec3(x, y, z));
        box->high = glm::max(box->high, glm::ivec3(x + 1, y + 1, z + 1));
      }
    }
  }
  box->low = glm::max(box->low - kBorderCells, glm::ivec3(0));
  box->high = glm::min(box->high + kBorderCells, grid.cells);
  return !box->Empty();
}

Training TrainingOf(const volume::RegularGrid& grid, const std::vector<float>& values,
                    const volume::CellBox& box) {
  Training training;
  training.grid = {box.high - box.low, grid.spacing_m,
                   grid.low_corner_m + glm::dvec3(box.low) * grid.spacing_m};
  training.middle_m = 0.5 * (training.grid.low_corner_m + training.grid.HighCorner_m());
  for (int z = box.low.z; z < box.high.z; ++z) {
    for (int y = box.low.y; y < box.high.y; ++y) {
      for (int x = box.low.x; x < box.high.x; ++x) {
        const float value = values[grid.Offset(x, y, z)];
        training.values.push_back(std::max(value, 0.0F));
        if (!(value > 0.0F)) continue;
        const glm::dvec3 middle_m =
            grid.low_corner_m + (glm::dvec3(x, y, z) + 0.5) * grid.spacing_m;
        training.points_m.emplace_back(middle_m - training.middle_m);
      }
    }
  }
  return training;
}

absl::Status Check(const FitOptions& options) {
  if (options.balls < 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("the number of balls is ", options.balls, "; give 1 or more"));
  }
  if (!(options.overlap >= 0.5 && options.overlap <= 10.0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("the overlap is ", options.overlap, "; it must be from 0.5 to 10"));
  }
  if (options.max_iterations < 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("the number of iterations is ", options.max_iterations, "; give 1 or more"));
  }
  return absl::OkStatus();
}

absl::StatusOr<volume::CellBox> CheckValues(const volume::RegularGrid& grid,
                                            const std::vector<float>& values,
                                            const FitOptions& options) {
  THUNDERHEAD_CHECK(values.size() == grid.CellCount(), std::to_string(values.size()));
  const auto cloudy = static_cast<std::size_t>(
      std::ranges::count_if(values, [](float value) { return value > 0.0F; }));
  volume::CellBox box;
  if (!FindBox(grid, values, &box)) {
    return absl::InvalidArgumentError("there is nothing to approximate: the volume is empty");
  }
  if (static_cast<std::size_t>(options.balls) > cloudy) {
    return absl::InvalidArgumentError(absl::StrCat(options.balls, " balls are more than the ",
                                                   cloudy, " cells with cloud; give fewer"));
  }
  return box;
}

int ThreadsOf(int threads) {
  if (threads > 0) return threads;
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

}  // namespace

std::vector<float> Evaluate(const MetaballCloud& cloud, const volume::RegularGrid& grid,
                            int threads) {
  std::vector<double> weights;
  for (const Metaball& ball : cloud.balls) weights.push_back(ball.weight);
  std::vector<float> field;
  BasisOperator(grid, cloud.balls, cloud.basis, cloud.overlap, ThreadsOf(threads))
      .Apply(weights, &field);
  for (float& value : field) value = std::max(value, 0.0F);
  return field;
}

absl::StatusOr<FitResult> Fit(const volume::RegularGrid& grid, const std::vector<float>& values,
                              const FitOptions& options,
                              const std::function<void(const FitProgress&)>& observer,
                              const std::stop_token& stop) {
  THUNDERHEAD_RETURN_IF_ERROR(Check(options));
  THUNDERHEAD_ASSIGN_OR_RETURN(const volume::CellBox box, CheckValues(grid, values, options));
  const Training training = TrainingOf(grid, values, box);
  const auto tell = [&observer](const FitProgress& progress) {
    if (observer) observer(progress);
  };
  ClusteringOptions clustering;
  clustering.centres = options.balls;
  clustering.seed = options.seed;
  clustering.threads = ThreadsOf(options.threads);
  const glm::dvec3& spacing_m = grid.spacing_m;
  const double min_sigma_m = 0.5 * std::max({spacing_m.x, spacing_m.y, spacing_m.z});
  const Clusters clusters = Cluster(
      training.points_m, min_sigma_m, clustering,
      [&](double share) {
        tell({"clustering", share, 0.0});
      },
      stop);
  if (clusters.epochs == 0) return absl::CancelledError("stopped before the first centres");
  FitResult result;
  result.cells = training.values.size();
  result.cloudy_cells = training.points_m.size();
  result.epochs = clusters.epochs;
  MetaballCloud& cloud = result.cloud;
  cloud.basis = options.basis;
  cloud.overlap = options.overlap;
  cloud.low_m = training.grid.low_corner_m;
  cloud.high_m = training.grid.HighCorner_m();
  for (std::size_t k = 0; k < clusters.centres_m.size(); ++k) {
    cloud.balls.push_back({clusters.centres_m[k] + training.middle_m, clusters.sigmas_m[k], 0.0});
  }
  const BasisOperator basis(training.grid, cloud.balls, options.basis, options.overlap,
                            clustering.threads);
  const WeightOptions weighing{options.non_negative, options.max_iterations, options.min_gain};
  const auto each = [&](int iteration, double error) {
    tell({"weights", static_cast<double>(iteration + 1) / options.max_iterations, error});
    return !stop.stop_requested();
  };
  OutputWeights weights = options.solver == Solver::kGradient
                              ? ByGradient(basis, training.values, weighing, each)
                              : ByLeastSquares(basis, training.values, weighing, each);
  for (std::size_t k = 0; k < cloud.balls.size(); ++k) cloud.balls[k].weight = weights.weights[k];
  result.error = weights.errors.back();
  result.relative_error = std::sqrt(result.error / weights.errors.front());
  result.errors = std::move(weights.errors);
  return result;
}

}  // namespace thunderhead::clouds
