#include "measure/against_truth.h"

#include <algorithm>
#include <utility>

#include "measure/image_error.h"
#include "reference/near_sun.h"
#include "reference/scene_problem.h"

namespace thunderhead::measure {

absl::StatusOr<AgainstTruth> AgainstTruth::Of(const scene::Scene& scene,
                                              const volume::HydrometeorFields& fields,
                                              picture::LinearPicture truth, double peak_cut_deg) {
  std::vector<bool> left_out =
      reference::NearSun(reference::CameraOf(scene, fields),
                         scene::Direction(scene.sun.azimuth_deg, scene.sun.elevation_deg),
                         truth.size_px, peak_cut_deg);
  const auto compared = static_cast<double>(std::ranges::count(left_out, false));
  if (compared < reference::kLeastAwayFromSun * static_cast<double>(left_out.size())) {
    return absl::InvalidArgumentError(
        "the camera shows little except the sun, and the reference shows no aureole around it; "
        "turn the camera away, widen its field of view or lower --peak-cut");
  }
  return AgainstTruth(std::move(truth), std::move(left_out));
}

AgainstTruth::AgainstTruth(picture::LinearPicture truth, std::vector<bool> left_out)
    : truth_(std::move(truth)),
      left_out_(std::move(left_out)),
      compared_(Without(left_out_, truth_)),
      noise_(RelativeNoise(compared_)) {}

double AgainstTruth::RelativeRmseWithoutNoise(const picture::LinearPicture& image) const {
  return RelativeRmseWithout(noise_, Without(left_out_, image), compared_);
}

double AgainstTruth::RelativeBias(const picture::LinearPicture& image) const {
  return measure::RelativeBias(Without(left_out_, image), compared_);
}

}  // namespace thunderhead::measure
