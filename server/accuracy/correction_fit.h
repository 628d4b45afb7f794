// Fits correction factors for drawn radiance. Multiplied by them, the drawn radiance agrees with
// better estimates that were traced along some rays. Factors depend on place and direction. The fit
// uses a pyramid of levels, from a single texel down to the finest level. Each texel is fitted by
// regularised linear least squares. Its prior is the factor of the coarser level at the same place,
// which dominates if the texel has few rays. The expected difference from the prior is estimated
// from the rays (empirical Bayes). This code does not depend on GL or scenes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "glm/vec3.hpp"
#include "glm/vec4.hpp"

namespace thunderhead::accuracy {

// A ray with its drawn radiance and an estimate of the reference radiance. The estimate may be
// noisy, even negative, but has almost no bias.
struct CorrectedRay {
  glm::dvec3 place{0.0};  // position at which the ray's factor is looked up, 0 to 1 along each side
                          // of the box
  glm::dvec3 direction{0.0};  // unit vector, or zero if factors do not depend on direction
  glm::dvec3 drawn{0.0};
  glm::dvec3 estimate{0.0};
};

// The coefficients of one texel, one vector for each colour. The factor for the direction d is
// dot(coefficients, (1, d)).
using Factors = std::array<glm::vec4, 3>;

class CorrectionFit {
 public:
  // `size` is the number of texels of the finest level along each side of the box.
  explicit CorrectionFit(const glm::ivec3& size);

  void Add(const CorrectedRay& ray);
  std::int64_t Rays() const { return rays_; }
  const glm::ivec3& Size() const { return finest_.size; }

  // Returns the factors of all texels of the finest level, x fastest. Without any rays, all factors
  // are 1.
  std::vector<Factors> Solve() const;

 private:
  // The normal equations of one texel, for the basis (1, x, y, z) of the ray's direction. Rays are
  // weighted by their drawn radiance, so that a texel's factor is the mean estimate divided by the
  // mean drawn radiance.
  struct Normal {
    std::array<float, 10> matrix{};  // upper triangle by rows
    std::array<std::array<float, 4>, 3> right{};

    void operator+=(const Normal& other);
    // Returns the mean over the colours of `right`.
    std::array<float, 4> GrayRight() const;
  };
  struct Level {
    glm::ivec3 size{0};
    std::vector<Normal> normals;
  };

  static Level Coarser(const Level& fine);
  static std::vector<Factors> SolveLevel(const Level& level, const std::vector<Factors>& above,
                                         const glm::ivec3& size_above, double variance,
                                         double spread);
  // Returns the spread: the root mean square difference of the texels' factors from their mean.
  // `variance` is the noise to subtract.
  static double SpreadOf(const Level& level, double variance);

  Level finest_;
  std::int64_t rays_ = 0;
  double spread_ = 0.0;  // weighted sum over rays of the squared difference of the ray's factor
                         // from 1
};

}  // namespace thunderhead::accuracy
