// Pictures of moving scenes, and the first picture at rest on a slow machine. They use rays where
// the picture needs them (frame/sparse_picture.h) and light that is solved less exactly. The final
// picture is never made in this way (docs/decisions/0052-sparse-pictures.md).
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

// Returns the contrast limit of the scene's pictures for frame::CompletePicture. It is
// kMovingContrast up to kMovingContrastPixels. Larger pictures may differ by more within a pixel,
// 2.2 times as much at 1280 x 720, because smaller pixels are less visible
// (docs/decisions/0052-sparse-pictures.md).
double MovingContrast(const scene::Scene& scene);
inline constexpr double kMovingContrast = 16.0;
inline constexpr double kMovingContrastPixels = 480.0 * 270.0;

// Settings of the light while the sun or a field changes, and for the first picture at rest after
// that (renderers::DrawQuality).
inline constexpr double kMovingLightTolerance = 4e-3;
inline constexpr double kMovingLightLayer = 1.6;

// Maximum number of pixels of a moving scene's frames. The work for each pixel of a picture, even
// with few rays, delays all other work (docs/reliability.md).
inline constexpr double kMaxMovingPixels = 1600.0 * 900.0;

// Returns FrameQuality::output_scale of the scene's frames while it moves.
double MovingOutputScale(const scene::Scene& scene);

// Returns the scene with a picture of `output_scale` times its width and height.
scene::Scene WithOutputScale(const scene::Scene& scene, double output_scale);

// Returns true for scenes that are drawn sparsely while they move.
bool MovesSparsely(const scene::Scene& scene);

// Returns the quality for the coarsest picture of such a scene. `quality` must be sparse.
renderers::DrawQuality MovingQuality(const scene::Scene& scene, const FrameQuality& quality);

using DrawChosen =
    std::function<absl::StatusOr<renderers::ChosenFrame>(const std::vector<glm::vec2>& places)>;

struct CompletedPicture {
  frame::ToneMapped mapped;
  frame::FineImage fine;  // the same with more bits
};

// Returns the whole picture from `coarse`, which was drawn with MovingQuality; `draw` adds rays to
// it. Adds the times of the drawing stages to `stages`. Call it during a drawing of `tone_mapper`'s
// pieces.
absl::StatusOr<CompletedPicture> CompleteMoving(
    const renderers::LinearFrame& coarse, const scene::Scene& scene, const FrameQuality& quality,
    frame::ToneMapper& tone_mapper, const DrawChosen& draw, renderers::StageTimes* stages);

}  // namespace thunderhead::accuracy
