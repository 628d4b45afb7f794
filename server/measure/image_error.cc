#include "measure/image_error.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/status.h"

namespace thunderhead::measure {
namespace {

double Sum(const glm::dvec3& color) { return color.x + color.y + color.z; }

double MeanRadiance(const picture::LinearPicture& image) {
  double sum = 0.0;
  for (const glm::vec3& pixel : image.radiance) sum += Sum(pixel);
  return sum / (3.0 * static_cast<double>(image.radiance.size()));
}

}  // namespace

picture::LinearPicture Without(const std::vector<bool>& left_out,
                               const picture::LinearPicture& image) {
  THUNDERHEAD_CHECK(left_out.size() == image.radiance.size(), std::to_string(left_out.size()));
  picture::LinearPicture rest;
  for (std::size_t i = 0; i < image.radiance.size(); ++i) {
    if (left_out[i]) continue;
    rest.radiance.push_back(image.radiance[i]);
    if (!image.standard_error.empty()) rest.standard_error.push_back(image.standard_error[i]);
  }
  rest.size_px = {static_cast<int>(rest.radiance.size()), 1};
  return rest;
}

double RelativeRmse(const picture::LinearPicture& image, const picture::LinearPicture& reference) {
  THUNDERHEAD_CHECK(image.size_px == reference.size_px, std::to_string(image.size_px.x));
  double squares = 0.0;
  for (std::size_t i = 0; i < reference.radiance.size(); ++i) {
    const glm::dvec3 difference = glm::dvec3(image.radiance[i]) - glm::dvec3(reference.radiance[i]);
    squares += Sum(difference * difference);
  }
  return std::sqrt(squares / (3.0 * static_cast<double>(reference.radiance.size()))) /
         MeanRadiance(reference);
}

double RelativeNoise(const picture::LinearPicture& reference) {
  THUNDERHEAD_CHECK(!reference.standard_error.empty(), "the reference has no standard error");
  double squares = 0.0;
  for (const glm::vec3& error : reference.standard_error)
    squares += Sum(glm::dvec3(error) * glm::dvec3(error));
  return std::sqrt(squares / (3.0 * static_cast<double>(reference.standard_error.size()))) /
         MeanRadiance(reference);
}

double RelativeRmseWithout(double reference_noise, const picture::LinearPicture& image,
                           const picture::LinearPicture& reference) {
  const double rmse = RelativeRmse(image, reference);
  return std::sqrt(std::max(rmse * rmse - reference_noise * reference_noise, 0.0));
}

double RelativeBias(const picture::LinearPicture& image, const picture::LinearPicture& reference) {
  return MeanRadiance(image) / MeanRadiance(reference) - 1.0;
}

}  // namespace thunderhead::measure
