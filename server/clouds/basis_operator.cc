#include "clouds/basis_operator.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "glm/common.hpp"
#include "physics/chunked_work.h"

namespace thunderhead::clouds {
namespace {

constexpr int kSlabLayers = 4;
constexpr int kBallsAChunk = 64;

// Number of partial sums. The compiler can keep eight of them in one vector register.
constexpr std::size_t kSimdWidth = 8;

// The values of a ball in one row of cells along x, for x from 0 to count - 1.
struct GaussianRow {
  float scale;
  const float* factors;

  float operator()(std::size_t x) const { return scale * factors[x]; }
};

struct WyvillRow {
  float base;
  const float* squares;

  float operator()(std::size_t x) const {
    const float t = std::min(base + squares[x], 1.0F);
    return 1.0F + t * (-22.0F / 9.0F + t * (17.0F / 9.0F - t * (4.0F / 9.0F)));
  }
};

template <typename Values, typename Weigh>
float SumRow(const Values& values, std::size_t count, const Weigh& weigh) {
  std::array<float, kSimdWidth> sums{};
  std::size_t x = 0;
  for (; x + kSimdWidth <= count; x += kSimdWidth) {
    for (std::size_t i = 0; i < kSimdWidth; ++i) {
      sums[i] += weigh(values(x + i), x + i);
    }
  }
  float sum = 0.0F;
  for (; x < count; ++x) sum += weigh(values(x), x);
  for (const float part : sums) sum += part;
  return sum;
}

}  // namespace

BasisOperator::BasisOperator(const volume::RegularGrid& grid, const std::vector<Metaball>& balls,
                             Basis basis, double overlap, int threads)
    : grid_(grid), basis_(basis), overlap_(overlap), threads_(threads) {
  footprints_.reserve(balls.size());
  for (const Metaball& ball : balls) AddFootprint(ball);
  slabs_.resize(static_cast<std::size_t>((grid.cells.z + kSlabLayers - 1) / kSlabLayers));
  for (std::size_t i = 0; i < footprints_.size(); ++i) {
    const Footprint& ball = footprints_[i];
    if (ball.Empty()) continue;
    for (int slab = ball.low.z / kSlabLayers; slab * kSlabLayers < ball.high.z; ++slab) {
      slabs_[static_cast<std::size_t>(slab)].push_back(static_cast<std::uint32_t>(i));
    }
  }
}

void BasisOperator::AddFootprint(const Metaball& ball) {
  Footprint footprint;
  footprint.reach_m = Reach_m(basis_, overlap_, ball.sigma_m);
  footprint.centre_cells = (ball.centre_m - grid_.low_corner_m) / grid_.spacing_m - 0.5;
  const glm::dvec3 reach_cells = footprint.reach_m / grid_.spacing_m;
  const glm::dvec3 cells(grid_.cells);
  footprint.low = glm::ivec3(
      glm::clamp(glm::ceil(footprint.centre_cells - reach_cells), glm::dvec3(0.0), cells));
  footprint.high = glm::ivec3(
      glm::clamp(glm::floor(footprint.centre_cells + reach_cells) + 1.0, glm::dvec3(0.0), cells));
  footprint.tables = tables_.size();
  for (int axis = 0; axis < 3; ++axis) {
    for (int cell = footprint.low[axis]; cell < footprint.high[axis]; ++cell) {
      const double away_m = (cell - footprint.centre_cells[axis]) * grid_.spacing_m[axis];
      if (basis_ == Basis::kGaussian) {
        const double ratio = away_m / (0.5 * overlap_ * ball.sigma_m);
        tables_.push_back(static_cast<float>(std::exp(-ratio * ratio)));
      } else {
        const double ratio = away_m / footprint.reach_m;
        tables_.push_back(static_cast<float>(ratio * ratio));
      }
    }
  }
  footprints_.push_back(footprint);
}

// Calls `row` for each row of cells that the ball reaches, for z from first_z to last_z - 1. The
// arguments are the ball's values in the row, the index of the row's first cell, and the number of
// cells.
template <typename Row>
void BasisOperator::ForRows(const Footprint& ball, int first_z, int last_z, const Row& row) const {
  const float* x_table = tables_.data() + ball.tables;
  const float* y_table = x_table + (ball.high.x - ball.low.x);
  const float* z_table = y_table + (ball.high.y - ball.low.y);
  for (int z = std::max(ball.low.z, first_z); z < std::min(ball.high.z, last_z); ++z) {
    const double dz_m = (z - ball.centre_cells.z) * grid_.spacing_m.z;
    for (int y = ball.low.y; y < ball.high.y; ++y) {
      const double dy_m = (y - ball.centre_cells.y) * grid_.spacing_m.y;
      const double left = ball.reach_m * ball.reach_m - dz_m * dz_m - dy_m * dy_m;
      if (left <= 0.0) continue;
      const double half = std::sqrt(left) / grid_.spacing_m.x;
      const int first =
          std::max(static_cast<int>(std::ceil(ball.centre_cells.x - half)), ball.low.x);
      const int last =
          std::min(static_cast<int>(std::floor(ball.centre_cells.x + half)) + 1, ball.high.x);
      if (first >= last) continue;
      const float* at_x = x_table + (first - ball.low.x);
      const float at_y = y_table[y - ball.low.y];
      const float at_z = z_table[z - ball.low.z];
      const std::size_t offset = grid_.Offset(first, y, z);
      const auto count = static_cast<std::size_t>(last - first);
      if (basis_ == Basis::kGaussian) {
        row(GaussianRow{at_y * at_z, at_x}, offset, count);
      } else {
        row(WyvillRow{at_y + at_z, at_x}, offset, count);
      }
    }
  }
}

void BasisOperator::Apply(const std::vector<double>& weights, std::vector<float>* field) const {
  field->assign(grid_.CellCount(), 0.0F);
  physics::WorkPlan plan;
  plan.threads = threads_;
  physics::ForEachChunk(static_cast<int>(slabs_.size()), plan, [&](int slab) {
    const int first_z = slab * kSlabLayers;
    for (const std::uint32_t i : slabs_[static_cast<std::size_t>(slab)]) {
      const auto weight = static_cast<float>(weights[i]);
      if (weight == 0.0F) continue;
      ForRows(footprints_[i], first_z, first_z + kSlabLayers,
              [&](const auto& values, std::size_t offset, std::size_t count) {
                float* to = field->data() + offset;
                for (std::size_t x = 0; x < count; ++x) to[x] += weight * values(x);
              });
    }
  });
}

// Returns for each ball the sum of sum(values, offset, count) over the ball's rows. ForRows defines
// the arguments of `sum`.
template <typename Sum>
std::vector<double> BasisOperator::SumOverRows(const Sum& sum) const {
  std::vector<double> sums(footprints_.size(), 0.0);
  const auto count = static_cast<int>(footprints_.size());
  physics::WorkPlan plan;
  plan.threads = threads_;
  physics::ForEachChunk((count + kBallsAChunk - 1) / kBallsAChunk, plan, [&](int chunk) {
    const int last = std::min(count, (chunk + 1) * kBallsAChunk);
    for (int ball = chunk * kBallsAChunk; ball < last; ++ball) {
      double total = 0.0;
      ForRows(footprints_[static_cast<std::size_t>(ball)], 0, grid_.cells.z,
              [&](const auto& values, std::size_t offset, std::size_t cells) {
                total += static_cast<double>(sum(values, offset, cells));
              });
      sums[static_cast<std::size_t>(ball)] = total;
    }
  });
  return sums;
}

void BasisOperator::ApplyTransposed(const std::vector<float>& field,
                                    std::vector<double>* sums) const {
  *sums = SumOverRows([&](const auto& values, std::size_t offset, std::size_t count) {
    const float* from = field.data() + offset;
    return SumRow(values, count, [from](float value, std::size_t x) { return value * from[x]; });
  });
}

std::vector<double> BasisOperator::SquaredNorms() const {
  return SumOverRows([](const auto& values, std::size_t, std::size_t count) {
    return SumRow(values, count, [](float value, std::size_t) { return value * value; });
  });
}

}  // namespace thunderhead::clouds
