#include "renderers/light_map.h"

#include <array>
#include <cmath>
#include <numbers>

namespace thunderhead::renderers {
namespace {

constexpr int kSines = 64;
constexpr int kAzimuths = 32;

std::array<double, 9> Harmonics(const glm::dvec3& n) {
  return {1.0,
          n.y,
          n.z,
          n.x,
          n.x * n.y,
          n.y * n.z,
          3.0 * n.z * n.z - 1.0,
          n.x * n.z,
          n.x * n.x - n.y * n.y};
}

// Weight of each spherical harmonic. It is the inverse of the mean of its square over the sphere,
// times a factor of its order. This factor comes from the convolution with the cosine and is 1, 2/3
// and 1/4 for the orders 0, 1 and 2.
constexpr std::array<double, 9> kWeights = {
    1.0, 2.0, 2.0, 2.0, 15.0 / 4.0, 15.0 / 4.0, 5.0 / 16.0, 15.0 / 4.0, 15.0 / 16.0};

}  // namespace

std::vector<glm::vec3> LightMapOf(
    const std::function<glm::vec3(const glm::vec3& direction)>& radiance_from) {
  std::array<glm::dvec3, 9> sums{};
  // The directions are evenly spaced in the sine of the elevation and in the azimuth. Each of them
  // represents the same solid angle, so all have the same weight.
  for (int i = 0; i < kSines; ++i) {
    const double sine = 2.0 * (i + 0.5) / kSines - 1.0;
    const double cosine = std::sqrt(1.0 - sine * sine);
    for (int j = 0; j < kAzimuths; ++j) {
      const double azimuth = 2.0 * std::numbers::pi * (j + 0.5) / kAzimuths;
      const glm::dvec3 direction(cosine * std::cos(azimuth), cosine * std::sin(azimuth), sine);
      const glm::dvec3 radiance(radiance_from(glm::vec3(direction)));
      const std::array<double, 9> values = Harmonics(direction);
      for (std::size_t k = 0; k < 9; ++k) sums[k] += values[k] * radiance;
    }
  }
  std::vector<glm::vec3> coefficients;
  for (std::size_t k = 0; k < 9; ++k) {
    coefficients.emplace_back(kWeights[k] / (kSines * kAzimuths) * sums[k]);
  }
  return coefficients;
}

}  // namespace thunderhead::renderers
