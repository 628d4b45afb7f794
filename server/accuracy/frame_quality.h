// The quality of a frame. Full quality means the scene's own slices at scale 1.
#pragma once

namespace thunderhead::accuracy {

struct FrameQuality {
  double image_scale =
      1.0;  // of the eye buffer's width and height, (0, 1]; the frame keeps its size
  double slice_share = 1.0;  // of the scene's slices, (0, 1]

  // Whether rays are placed where the picture needs them (accuracy/moving_picture.h), for
  // techniques that support it. A smaller image_scale means fewer rays.
  bool sparse = false;

  // Scale of the frame's own width and height, (0, 1]. Below 1 the frame is smaller than the
  // scene's picture.
  double output_scale = 1.0;

  // Returns the combined scale, relative to a picture of the scene's size.
  double Scale() const { return image_scale * output_scale; }

  bool operator==(const FrameQuality&) const = default;
};

}  // namespace thunderhead::accuracy
