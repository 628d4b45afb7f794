#include "renderers/light_volume/linked_cells.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "renderers/light_volume/shares.h"

namespace thunderhead::renderers {
namespace {

constexpr int kMaxIterations = 200;

// Adds up partial sums in order, so that the total does not depend on the number of threads.
double Total(const std::vector<double>& sums) {
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace

LinkedCells::LinkedCells(std::vector<Links> down, std::vector<Links> up,
                         const std::vector<float>& loss, std::vector<std::size_t> blocks)
    : down_(std::move(down)), up_(std::move(up)), blocks_(std::move(blocks)) {
  diagonal_.assign(loss.size(), 0.0F);
  for (std::size_t n = 0; n < loss.size(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      diagonal_[n] += down_[n].conductance[axis];
      diagonal_[n] += up_[n].conductance[axis];
    }
    diagonal_[n] += loss[n];
  }
  Factor();
}

// Incomplete Cholesky factorisation without fill-in. For a matrix with these links, only the
// diagonal changes. Links between blocks are omitted. They connect columns of cells, and the
// resistance between columns is larger than within a column.
void LinkedCells::Factor() {
  inverse_pivot_.resize(diagonal_.size());
  tbb::parallel_for(std::size_t{1}, blocks_.size(), [&](std::size_t block) {
    const std::size_t begin = blocks_[block - 1];
    for (std::size_t n = begin; n < blocks_[block]; ++n) {
      float pivot = diagonal_[n];
      for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t to = down_[n].to[axis];
        if (to < static_cast<std::int32_t>(begin)) continue;  // also skips NumberedCells::kNone
        const float conductance = down_[n].conductance[axis];
        pivot -= conductance * conductance * inverse_pivot_[static_cast<std::size_t>(to)];
      }
      inverse_pivot_[n] = 1.0F / pivot;
    }
  });
}

double LinkedCells::Precondition(const std::vector<float>& from, std::vector<float>* to) const {
  std::vector<float>& x = *to;
  const auto forward = [&](std::size_t n, std::size_t begin) {
    float sum = from[n];
    const Links& down = down_[n];
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t other = down.to[axis];
      if (other < static_cast<std::int32_t>(begin)) continue;  // also skips NumberedCells::kNone
      sum += down.conductance[axis] * x[static_cast<std::size_t>(other)];
    }
    x[n] = sum * inverse_pivot_[n];
  };
  const auto backward = [&](std::size_t n, std::size_t end) {
    float sum = 0.0F;
    const Links& up = up_[n];
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t other = up.to[axis];
      if (other == NumberedCells::kNone || other >= static_cast<std::int32_t>(end)) continue;
      sum += up.conductance[axis] * x[static_cast<std::size_t>(other)];
    }
    x[n] += sum * inverse_pivot_[n];
    return static_cast<double>(from[n] * x[n]);
  };
  // Each cell depends on the cell before it, so one block alone would keep a processor waiting. Two
  // blocks are therefore interleaved.
  const std::size_t blocks = blocks_.size() - 1;
  std::vector<double> products((blocks + 1) / 2);
  tbb::parallel_for(std::size_t{0}, products.size(), [&](std::size_t pair) {
    const std::size_t a = blocks_[2 * pair];
    const std::size_t b = blocks_[2 * pair + 1];
    const std::size_t c = 2 * pair + 1 < blocks ? blocks_[2 * pair + 2] : b;
    const std::size_t both = std::min(b - a, c - b);
    for (std::size_t i = 0; i < both; ++i) {
      forward(a + i, a);
      forward(b + i, b);
    }
    for (std::size_t n = a + both; n < b; ++n) forward(n, a);
    for (std::size_t n = b + both; n < c; ++n) forward(n, b);
    double product = 0.0;
    for (std::size_t i = 0; i < both; ++i) {
      product += backward(b - 1 - i, b);
      product += backward(c - 1 - i, c);
    }
    for (std::size_t n = b - both; n-- > a;) product += backward(n, b);
    for (std::size_t n = c - both; n-- > b;) product += backward(n, c);
    products[pair] = product;
  });
  return Total(products);
}

double LinkedCells::Apply(const std::vector<float>& from, std::vector<float>* to) const {
  std::vector<double> products((from.size() + kShare - 1) / kShare);
  ForShares(from.size(), [&](std::size_t begin, std::size_t end) {
    double product = 0.0;
    for (std::size_t n = begin; n < end; ++n) {
      float sum = diagonal_[n] * from[n];
      const Links& down = down_[n];
      const Links& up = up_[n];
      for (int axis = 0; axis < 3; ++axis) {
        for (const Links* links : {&down, &up}) {
          const std::int32_t other = links->to[axis];
          if (other == NumberedCells::kNone) continue;
          sum -= links->conductance[axis] * from[static_cast<std::size_t>(other)];
        }
      }
      (*to)[n] = sum;
      product += static_cast<double>(from[n] * sum);
    }
    products[begin / kShare] = product;
  });
  return Total(products);
}

// Solves the system by preconditioned conjugate gradients.
int LinkedCells::Solve(const std::vector<float>& right, double tolerance,
                       std::vector<float>* solution) {
  const std::size_t count = right.size();
  residual_.resize(count);
  direction_.assign(count, 0.0F);
  image_.resize(count);
  better_.resize(count);
  Apply(*solution, &image_);
  ForShares(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) residual_[n] = right[n] - image_[n];
  });
  const double goal = tolerance * tolerance * Precondition(right, &better_);
  double before = 0.0;
  int iterations = 0;
  for (; iterations < kMaxIterations; ++iterations) {
    const double now = Precondition(residual_, &better_);
    if (!(now > goal)) break;
    const auto beta = static_cast<float>(before > 0.0 ? now / before : 0.0);
    before = now;
    ForShares(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) direction_[n] = better_[n] + beta * direction_[n];
    });
    const double curvature = Apply(direction_, &image_);
    if (!(curvature > 0.0)) break;
    const auto step = static_cast<float>(now / curvature);
    ForShares(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        (*solution)[n] += step * direction_[n];
        residual_[n] -= step * image_[n];
      }
    });
  }
  return iterations;
}

}  // namespace thunderhead::renderers
