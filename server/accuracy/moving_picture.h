// Pictures while something moves, and the first at rest of a slow machine: rays where the picture
// needs them (frame/sparse_picture.h), and light that is solved for less exactly. The final picture
// is none of it (docs/decisions/0052-sparse-pictures.md).
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

// As frame::CompletePicture takes it, of the scene's pictures: kMovingContrast up to
// kMovingContrastPixels; larger ones may differ by more within a pixel, 2.2 times as much at 1280
// x 720, as smaller pixels are seen less (docs/decisions/0052-sparse-pictures.md).
double MovingContrast(const scene::Scene& scene);
inline constexpr double kMovingContrast = 16.0;
inline constexpr double kMovingContrastPixels = 480.0 * 270.0;

// Of the light while the sun or a field changes, and in the first picture at rest after it
// (renderers::DrawQuality).
inline constexpr double kMovingLightTolerance = 4e-3;
inline constexpr double kMovingLightLayer = 1.6;

// Frames of a moving scene that asks for more pixels have so many: the work that is done for each
// of a picture's pixels, however few have rays, holds up all others (docs/reliability.md).
inline constexpr double kMaxMovingPixels = 1600.0 * 900.0;

// FrameQuality::output_scale of the scene's frames while it moves.
double MovingOutputScale(const scene::Scene& scene);

// The scene with a picture of `output_scale` of its width and height.
scene::Scene WithOutputScale(const scene::Scene& scene, double output_scale);

// True for scenes that are drawn so while they move.
bool MovesSparsely(const scene::Scene& scene);

// To draw the coarsest picture of such a scene with; `quality` is sparse.
renderers::DrawQuality MovingQuality(const scene::Scene& scene, const FrameQuality& quality);

using DrawChosen =
    std::function<absl::StatusOr<renderers::ChosenFrame>(const std::vector<glm::vec2>& places)>;

struct CompletedPicture {
  frame::ToneMapped mapped;
  frame::FineImage fine;  // the same with more bits
};

// The whole picture from `coarse`, which was drawn with MovingQuality and is coarse; `draw` adds
// to it. Adds the times of the stages of that to `stages`. Call it during a drawing of
// `tone_mapper`'s pieces.
absl::StatusOr<CompletedPicture> CompleteMoving(
    const renderers::LinearFrame& coarse, const scene::Scene& scene, const FrameQuality& quality,
    frame::ToneMapper& tone_mapper, const DrawChosen& draw, renderers::StageTimes* stages);

}  // namespace thunderhead::accuracy
