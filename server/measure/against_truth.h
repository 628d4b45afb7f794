// Compares pictures of a scene with the one that the reference traces of it, where the two show the
// same: not next to the sun (reference/near_sun.h).
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "picture/linear_picture.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::measure {

class AgainstTruth {
 public:
  // `truth` was traced with `peak_cut_deg` and has a standard error. INVALID_ARGUMENT if it shows
  // hardly anything but the sun.
  static absl::StatusOr<AgainstTruth> Of(const scene::Scene& scene,
                                         const volume::HydrometeorFields& fields,
                                         picture::LinearPicture truth, double peak_cut_deg);

  // Of pictures as large as the truth; as measure/image_error.h has them.
  double RelativeRmseWithoutNoise(const picture::LinearPicture& image) const;
  double RelativeBias(const picture::LinearPicture& image) const;
  // Relative RMSE of the truth's own noise.
  double Noise() const { return noise_; }

  // All of it.
  const picture::LinearPicture& Truth() const { return truth_; }

 private:
  AgainstTruth(picture::LinearPicture truth, std::vector<bool> left_out);

  picture::LinearPicture truth_;
  std::vector<bool> left_out_;
  picture::LinearPicture compared_;  // the truth without them
  double noise_;
};

}  // namespace thunderhead::measure
