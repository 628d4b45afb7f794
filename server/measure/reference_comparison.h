// Compares pictures of a scene with its path-traced reference picture. Pixels next to the sun are
// left out, because the two pictures differ there by design (reference/near_sun.h).
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "picture/linear_picture.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::measure {

class ReferenceComparison {
 public:
  // Creates a comparison. `reference`, the reference picture, must be traced with `peak_cut_deg`
  // and have a standard error. Returns INVALID_ARGUMENT if almost all of its pixels are next to the
  // sun.
  static absl::StatusOr<ReferenceComparison> Of(const scene::Scene& scene,
                                                const volume::HydrometeorFields& fields,
                                                picture::LinearPicture reference,
                                                double peak_cut_deg);

  // Return the errors of a picture of the reference's size, as defined in measure/image_error.h.
  double RelativeRmseWithoutNoise(const picture::LinearPicture& image) const;
  double RelativeBias(const picture::LinearPicture& image) const;
  // Returns the relative RMSE of the reference's own noise.
  double Noise() const { return noise_; }

  // Returns the whole reference picture.
  const picture::LinearPicture& Reference() const { return reference_; }

 private:
  ReferenceComparison(picture::LinearPicture reference, std::vector<bool> left_out);

  picture::LinearPicture reference_;
  std::vector<bool> left_out_;
  picture::LinearPicture compared_;  // the reference without the left-out pixels
  double noise_;
};

}  // namespace thunderhead::measure
