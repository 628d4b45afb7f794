#include "measure/image_error.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/status.h"

namespace thunderhead::measure {
namespace {

double Sum(const glm::dvec3& color) { return color.x + color.y + color.z; }

double MeanRadiance(const LinearImage& image) {
  double sum = 0.0;
  for (const glm::vec3& pixel : image.radiance) sum += Sum(pixel);
  return sum / (3.0 * static_cast<double>(image.radiance.size()));
}

}  // namespace

double RelativeRmse(const LinearImage& image, const LinearImage& truth) {
  THUNDERHEAD_CHECK(image.size_px == truth.size_px, std::to_string(image.size_px.x));
  double squares = 0.0;
  for (std::size_t i = 0; i < truth.radiance.size(); ++i) {
    const glm::dvec3 difference = glm::dvec3(image.radiance[i]) - glm::dvec3(truth.radiance[i]);
    squares += Sum(difference * difference);
  }
  return std::sqrt(squares / (3.0 * static_cast<double>(truth.radiance.size()))) /
         MeanRadiance(truth);
}

double RelativeNoise(const std::vector<glm::vec3>& standard_error, const LinearImage& truth) {
  double squares = 0.0;
  for (const glm::vec3& error : standard_error)
    squares += Sum(glm::dvec3(error) * glm::dvec3(error));
  return std::sqrt(squares / (3.0 * static_cast<double>(standard_error.size()))) /
         MeanRadiance(truth);
}

double RelativeRmseWithout(double truth_noise, const LinearImage& image, const LinearImage& truth) {
  const double rmse = RelativeRmse(image, truth);
  return std::sqrt(std::max(rmse * rmse - truth_noise * truth_noise, 0.0));
}

double RelativeBias(const LinearImage& image, const LinearImage& truth) {
  return MeanRadiance(image) / MeanRadiance(truth) - 1.0;
}

}  // namespace thunderhead::measure
