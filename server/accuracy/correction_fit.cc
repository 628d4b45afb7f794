#include "accuracy/correction_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "glm/common.hpp"

namespace thunderhead::accuracy {
namespace {

// kStep is the prior standard deviation of a texel's factor, divided by the spread of the factors
// (their deviation from the mean, SpreadOf; see docs/decisions/0012-traced-light.md). It applies to
// the difference from the coarser level and to each term that depends on direction. For single
// colours it is multiplied by kColorShare, because their estimates are the noisiest.
constexpr double kStep = 1.5;
constexpr double kColorShare = 0.2;
// The spread of the factors is computed on a level with at most this many texels along each side,
// so that each texel has many rays.
constexpr int kSpreadTexels = 12;
constexpr double kMinSpread = 0.03;
constexpr double kMaxSpread = 1.0;

constexpr double kMinDrawn = 1e-9;
// If a ray's drawn radiance in one colour is below this fraction of the mean over its colours, this
// colour uses the factor of the mean.
constexpr double kMinColorShare = 0.05;
// Limits the contribution of a single outlier to the estimate of the rays' variance.
constexpr double kMaxRayError = 10.0;

std::size_t Offset(const glm::ivec3& size, const glm::ivec3& texel) {
  return (static_cast<std::size_t>(texel.z) * static_cast<std::size_t>(size.y) +
          static_cast<std::size_t>(texel.y)) *
             static_cast<std::size_t>(size.x) +
         static_cast<std::size_t>(texel.x);
}

std::size_t Count(const glm::ivec3& size) {
  return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
         static_cast<std::size_t>(size.z);
}

template <typename Visit>
void ForEachTexel(const glm::ivec3& size, const Visit& visit) {
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) visit(glm::ivec3(x, y, z));
    }
  }
}

// A texel and its weight in a linear interpolation.
struct Corner {
  std::size_t offset = 0;
  float share = 0.0F;
};

// Returns the eight texels and weights of a linear interpolation at `place`, clamped at the edges.
std::array<Corner, 8> CornersAt(const glm::ivec3& size, const glm::dvec3& place) {
  const glm::dvec3 at = glm::clamp(place, 0.0, 1.0) * glm::dvec3(size) - 0.5;
  const glm::dvec3 low = glm::floor(at);
  const glm::dvec3 beyond = at - low;
  std::array<Corner, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::ivec3 step(i & 1U, (i >> 1U) & 1U, i >> 2U);
    const glm::dvec3 shares = glm::mix(1.0 - beyond, beyond, glm::dvec3(step));
    const glm::ivec3 texel = glm::clamp(glm::ivec3(low) + step, glm::ivec3(0), size - 1);
    corners[i] = {Offset(size, texel), static_cast<float>(shares.x * shares.y * shares.z)};
  }
  return corners;
}

// Solves (matrix + diag(ridge)) x = right + ridge * prior by Cholesky's method; ridge > 0.
glm::vec4 SolveRidge(const std::array<float, 10>& matrix, const std::array<float, 4>& right,
                     const glm::dvec4& ridge, const glm::vec4& prior) {
  double factor[4][4];
  double x[4];
  std::size_t next = 0;
  for (int row = 0; row < 4; ++row) {
    for (int column = row; column < 4; ++column) factor[column][row] = matrix[next++];
    factor[row][row] += ridge[row];
    x[row] = right[static_cast<std::size_t>(row)] + ridge[row] * prior[row];
  }
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column <= row; ++column) {
      for (int k = 0; k < column; ++k) factor[row][column] -= factor[row][k] * factor[column][k];
      if (column < row) factor[row][column] /= factor[column][column];
    }
    // Rounding errors of the sums in single precision could make this value negative. The lower
    // limit is larger than these errors.
    factor[row][row] = std::sqrt(std::max(factor[row][row], 1e-3 * ridge[row]));
    for (int k = 0; k < row; ++k) x[row] -= factor[row][k] * x[k];
    x[row] /= factor[row][row];
  }
  for (int row = 3; row >= 0; --row) {
    for (int k = row + 1; k < 4; ++k) x[row] -= factor[k][row] * x[k];
    x[row] /= factor[row][row];
  }
  return {x[0], x[1], x[2], x[3]};
}

constexpr Factors kNone = {glm::vec4(1.0F, 0.0F, 0.0F, 0.0F), glm::vec4(1.0F, 0.0F, 0.0F, 0.0F),
                           glm::vec4(1.0F, 0.0F, 0.0F, 0.0F)};

Factors FetchedAt(const std::vector<Factors>& factors, const glm::ivec3& size,
                  const glm::dvec3& place) {
  Factors fetched{};
  for (const Corner& corner : CornersAt(size, place)) {
    for (std::size_t color = 0; color < fetched.size(); ++color) {
      fetched[color] += corner.share * factors[corner.offset][color];
    }
  }
  return fetched;
}

}  // namespace

void CorrectionFit::Normal::operator+=(const Normal& other) {
  for (std::size_t i = 0; i < matrix.size(); ++i) matrix[i] += other.matrix[i];
  for (std::size_t color = 0; color < right.size(); ++color) {
    for (std::size_t i = 0; i < 4; ++i) right[color][i] += other.right[color][i];
  }
}

std::array<float, 4> CorrectionFit::Normal::GrayRight() const {
  std::array<float, 4> gray{};
  for (std::size_t i = 0; i < gray.size(); ++i) {
    gray[i] = (right[0][i] + right[1][i] + right[2][i]) / 3.0F;
  }
  return gray;
}

CorrectionFit::CorrectionFit(const glm::ivec3& size) {
  finest_.size = size;
  finest_.normals.resize(Count(size));
}

void CorrectionFit::Add(const CorrectedRay& ray) {
  const double brightness = (ray.drawn.x + ray.drawn.y + ray.drawn.z) / 3.0;
  if (!(brightness > kMinDrawn)) return;
  const double gray = (ray.estimate.x + ray.estimate.y + ray.estimate.z) / 3.0 / brightness;
  glm::dvec3 factor(gray);
  for (int color = 0; color < 3; ++color) {
    if (ray.drawn[color] > kMinColorShare * brightness) {
      factor[color] = ray.estimate[color] / ray.drawn[color];
    }
  }
  const double off = std::min(std::abs(gray - 1.0), kMaxRayError);
  spread_ += brightness * off * off;
  ++rays_;
  const double basis[4] = {1.0, ray.direction.x, ray.direction.y, ray.direction.z};
  for (const Corner& corner : CornersAt(finest_.size, ray.place)) {
    Normal& normal = finest_.normals[corner.offset];
    const double weight = brightness * corner.share;
    std::size_t next = 0;
    for (std::size_t row = 0; row < 4; ++row) {
      for (std::size_t column = row; column < 4; ++column) {
        normal.matrix[next++] += static_cast<float>(weight * basis[row] * basis[column]);
      }
      for (int color = 0; color < 3; ++color) {
        normal.right[static_cast<std::size_t>(color)][row] +=
            static_cast<float>(weight * factor[color] * basis[row]);
      }
    }
  }
}

CorrectionFit::Level CorrectionFit::Coarser(const Level& fine) {
  Level coarse;
  coarse.size = (fine.size + 1) / 2;
  coarse.normals.resize(Count(coarse.size));
  ForEachTexel(fine.size, [&](const glm::ivec3& texel) {
    coarse.normals[Offset(coarse.size, texel / 2)] += fine.normals[Offset(fine.size, texel)];
  });
  return coarse;
}

std::vector<Factors> CorrectionFit::SolveLevel(const Level& level,
                                               const std::vector<Factors>& above,
                                               const glm::ivec3& size_above, double variance,
                                               double spread) {
  const glm::dvec4 ridge(variance / (kStep * kStep * spread * spread));
  const glm::dvec4 color_ridge = ridge / (kColorShare * kColorShare);
  std::vector<Factors> factors(level.normals.size());
  ForEachTexel(level.size, [&](const glm::ivec3& texel) {
    // A texel of the coarser level covers two texels of this level along each side. The last texel
    // along a side may cover only one.
    const glm::dvec3 place = (glm::dvec3(texel) + 0.5) / (2.0 * glm::dvec3(size_above));
    const Factors prior = FetchedAt(above, size_above, place);
    const std::size_t offset = Offset(level.size, texel);
    const Normal& normal = level.normals[offset];
    factors[offset] = prior;
    if (!(normal.matrix[0] > 0.0F)) return;
    const std::array<float, 4> gray_right = normal.GrayRight();
    const glm::vec4 gray_prior = (prior[0] + prior[1] + prior[2]) / 3.0F;
    const glm::vec4 gray = SolveRidge(normal.matrix, gray_right, ridge, gray_prior);
    for (std::size_t color = 0; color < prior.size(); ++color) {
      std::array<float, 4> right = normal.right[color];
      for (std::size_t i = 0; i < 4; ++i) right[i] -= gray_right[i];
      factors[offset][color] =
          gray + SolveRidge(normal.matrix, right, color_ridge, prior[color] - gray_prior);
    }
  });
  return factors;
}

// Uses the method of moments: the expected contribution of noise with this variance is subtracted
// from the sum of squares.
double CorrectionFit::SpreadOf(const Level& level, double variance) {
  double weights = 0.0;
  double sum = 0.0;
  for (const Normal& normal : level.normals) {
    weights += normal.matrix[0];
    sum += normal.GrayRight()[0];
  }
  double squares = 0.0;
  for (const Normal& normal : level.normals) {
    const double weight = normal.matrix[0];
    if (!(weight > 0.0)) continue;
    const double off = normal.GrayRight()[0] / weight - sum / weights;
    squares += weight * off * off - variance;
  }
  if (!(squares > 0.0)) return kMinSpread;
  return std::clamp(std::sqrt(squares / weights), kMinSpread, kMaxSpread);
}

std::vector<Factors> CorrectionFit::Solve() const {
  std::vector<Level> coarser;  // all levels except the finest, in order of decreasing resolution
  const auto level = [&](std::size_t i) -> const Level& {
    return i == 0 ? finest_ : coarser[i - 1];
  };
  while (level(coarser.size()).size != glm::ivec3(1)) {
    coarser.push_back(Coarser(level(coarser.size())));
  }
  // The variance of a factor that is estimated from one ray whose drawn radiance is 1.
  const double variance = std::max(spread_ / std::max(static_cast<double>(rays_), 1.0), 1e-9);
  std::size_t settled = 0;
  while (std::max({level(settled).size.x, level(settled).size.y, level(settled).size.z}) >
         kSpreadTexels) {
    ++settled;
  }
  const double spread = SpreadOf(level(settled), variance);
  std::vector<Factors> above(1, kNone);
  glm::ivec3 size_above(1);
  for (std::size_t i = coarser.size() + 1; i-- > 0;) {
    // The coarsest level has one texel with all rays, so its factor is reliable. Its prior is
    // therefore weak, and the factor may differ much from 1.
    const double step = i == coarser.size() ? kMaxSpread : spread;
    above = SolveLevel(level(i), above, size_above, variance, step);
    size_above = level(i).size;
  }
  return above;
}

}  // namespace thunderhead::accuracy
