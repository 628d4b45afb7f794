// How finely a frame is drawn; full quality is the scene's own slices at scale 1.
#pragma once

namespace thunderhead::accuracy {

struct FrameQuality {
  double image_scale =
      1.0;  // of the eye buffer's width and height, (0, 1]; the frame keeps its size
  double slice_share = 1.0;  // of the scene's slices, (0, 1]

  // Rays where the picture needs them (accuracy/moving_picture.h), for techniques that draw such
  // pictures: the smaller image_scale, the fewer.
  bool sparse = false;

  // Of the frame's own width and height, (0, 1]: below 1 it is smaller than the scene's picture.
  double output_scale = 1.0;

  // Of both: how fine a picture of the scene's size it makes.
  double Scale() const { return image_scale * output_scale; }

  bool operator==(const FrameQuality&) const = default;
};

}  // namespace thunderhead::accuracy
