#include "measure/reference_comparison.h"

#include <algorithm>
#include <utility>

#include "measure/image_error.h"
#include "reference/near_sun.h"
#include "reference/scene_problem.h"

namespace thunderhead::measure {

absl::StatusOr<ReferenceComparison> ReferenceComparison::Of(const scene::Scene& scene,
                                                            const volume::HydrometeorFields& fields,
                                                            picture::LinearPicture reference,
                                                            double peak_cut_deg) {
  std::vector<bool> left_out =
      reference::NearSun(reference::CameraOf(scene, fields),
                         scene::Direction(scene.sun.azimuth_deg, scene.sun.elevation_deg),
                         reference.size_px, peak_cut_deg);
  const auto compared = static_cast<double>(std::ranges::count(left_out, false));
  if (compared < reference::kLeastAwayFromSun * static_cast<double>(left_out.size())) {
    return absl::InvalidArgumentError(
        "the camera shows little except the sun, and the reference shows no aureole around it; "
        "turn the camera away, widen its field of view or lower --peak-cut");
  }
  return ReferenceComparison(std::move(reference), std::move(left_out));
}

ReferenceComparison::ReferenceComparison(picture::LinearPicture reference,
                                         std::vector<bool> left_out)
    : reference_(std::move(reference)),
      left_out_(std::move(left_out)),
      compared_(Without(left_out_, reference_)),
      noise_(RelativeNoise(compared_)) {}

double ReferenceComparison::RelativeRmseWithoutNoise(const picture::LinearPicture& image) const {
  return RelativeRmseWithout(noise_, Without(left_out_, image), compared_);
}

double ReferenceComparison::RelativeBias(const picture::LinearPicture& image) const {
  return measure::RelativeBias(Without(left_out_, image), compared_);
}

}  // namespace thunderhead::measure
