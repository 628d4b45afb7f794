// The quality of a frame. Full quality means scale 1 and all slices of the scene's settings.
#pragma once

namespace thunderhead::accuracy {

struct FrameQuality {
  // Factor of the eye buffer's width and height, (0, 1]. The frame keeps its size.
  double image_scale = 1.0;
  double slice_share = 1.0;  // share of the scene's slices, (0, 1]

  // True if the picture is drawn sparsely: rays are placed only where the picture needs them
  // (accuracy/moving_picture.h). Not all techniques support it. A smaller image_scale then means
  // fewer rays.
  bool sparse = false;

  // Scale of the frame's own width and height, above 0 and at most 1. If it is below 1, the frame
  // is smaller than the size that the scene requests.
  double output_scale = 1.0;

  // Returns the scale of the frame buffer relative to the size that the scene requests.
  double Scale() const { return image_scale * output_scale; }

  bool operator==(const FrameQuality&) const = default;
};

}  // namespace thunderhead::accuracy
