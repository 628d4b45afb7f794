// Draws sparse pictures: frames of moving scenes and, on a slow machine, the first frame at rest.
// Sparse pictures have rays only where the picture needs them (frame/sparse_picture.h), and their
// light is solved less exactly. The final picture at rest is never sparse
// (docs/decisions/0052-sparse-pictures.md).
#pragma once

#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "accuracy/frame_quality.h"
#include "frame/tone_map.h"
#include "glm/vec2.hpp"
#include "renderers/scene_renderer.h"
#include "scene/scene.h"

namespace thunderhead::accuracy {

// Returns the contrast limit of the scene's pictures for frame::CompletePicture. The limit is
// kMovingContrast for pictures with up to kMovingContrastPixels pixels. It is larger for larger
// pictures, for example 2.2 times at 1280 x 720 pixels, because smaller pixels are less visible
// (docs/decisions/0052-sparse-pictures.md).
double MovingContrast(const scene::Scene& scene);
inline constexpr double kMovingContrast = 16.0;
inline constexpr double kMovingContrastPixels = 480.0 * 270.0;

// The accuracy of the light (renderers::DrawQuality) while the sun or a field changes, and for the
// first picture at rest after such a change.
inline constexpr double kMovingLightTolerance = 4e-3;
inline constexpr double kMovingLightLayer = 1.6;

// Maximum number of pixels of a moving scene's frames. It is limited because each pixel costs some
// work even if it has no ray, and this work delays all other work (docs/reliability.md).
inline constexpr double kMaxMovingPixels = 1600.0 * 900.0;

// Returns FrameQuality::output_scale for the frames of `scene` while the scene or camera moves.
double MovingOutputScale(const scene::Scene& scene);

// Returns the scene with a picture of `output_scale` times its width and height.
scene::Scene WithOutputScale(const scene::Scene& scene, double output_scale);

// Returns true for scenes whose pictures are drawn sparsely while the scene or camera moves.
bool MovesSparsely(const scene::Scene& scene);

// Returns the quality for drawing the coarse picture with which a sparse picture begins. For scenes
// that are not drawn sparsely (MovesSparsely), it is the quality of an ordinary picture.
renderers::DrawQuality MovingQuality(const scene::Scene& scene, const FrameQuality& quality);

using DrawChosen =
    std::function<absl::StatusOr<renderers::ChosenFrame>(const std::vector<glm::vec2>& places)>;

struct CompletedPicture {
  frame::ToneMapped mapped;
  frame::FineImage fine;  // the same picture with more bits per colour
};

// Completes the picture that begins with `coarse`, which was drawn with MovingQuality. It calls
// `draw` to draw additional rays, and adds the times of the drawing stages to `stages`. It must be
// called on the drawing thread, while a drawing in the pieces of `tone_mapper` is in progress.
absl::StatusOr<CompletedPicture> CompleteMoving(
    const renderers::LinearFrame& coarse, const scene::Scene& scene, const FrameQuality& quality,
    frame::ToneMapper& tone_mapper, const DrawChosen& draw, renderers::StageTimes* stages);

}  // namespace thunderhead::accuracy
