// Fits factors that multiply drawn radiance so that it agrees with better estimates along some
// rays. Factors depend on place and direction. The fit is regularised linear least squares for each
// texel of a pyramid, from one texel down to the finest level. The texel above is the prior, which
// dominates in texels with few rays. How much texels and directions may differ from it is estimated
// from the rays (empirical Bayes). Knows no GL and no scene.
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
  glm::dvec3 place{0.0};  // where the ray's factor is looked up, 0 to 1 along each side of a box
  glm::dvec3 direction{0.0};  // unit vector; zero if factors do not depend on direction
  glm::dvec3 drawn{0.0};
  glm::dvec3 estimate{0.0};
};

// Coefficients of one texel, by colour: the factor for direction d is dot(coefficients, (1, d)).
using Factors = std::array<glm::vec4, 3>;

class CorrectionFit {
 public:
  // `size` is the number of texels of the finest level over the box.
  explicit CorrectionFit(const glm::ivec3& size);

  void Add(const CorrectedRay& ray);
  std::int64_t Rays() const { return rays_; }
  const glm::ivec3& Size() const { return finest_.size; }

  // Returns the factors of all texels, x fastest. They are 1 if there are no rays nearby.
  std::vector<Factors> Solve() const;

 private:
  // The normal equations of one texel, for the basis (1, x, y, z) of the ray's direction. Rays are
  // weighted by their drawn radiance, so that a texel's factor is the mean estimate divided by the
  // mean drawn radiance.
  struct Normal {
    std::array<float, 10> matrix{};  // upper triangle by rows
    std::array<std::array<float, 4>, 3> right{};

    void operator+=(const Normal& other);
    // Returns the mean of the colours' right sides.
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
  // Returns the root mean square difference of the texels' factors from their mean.
  static double SpreadOf(const Level& level, double variance);

  Level finest_;
  std::int64_t rays_ = 0;
  double spread_ = 0.0;  // weighted sum of the rays' squared differences from a factor of 1
};

}  // namespace thunderhead::accuracy
