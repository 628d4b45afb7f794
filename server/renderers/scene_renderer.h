// Renders a scene and a storm's fields to a linear frame, which is a picture of linear radiance. It
// keeps each stage's result and reruns from the first stage whose inputs have changed. The class
// owns GL objects, so use it on the context's thread.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gl/objects.h"
#include "gl/whole_target.h"
#include "renderers/chosen_rays.h"
#include "renderers/sun_glow.h"
#include "renderers/technique.h"
#include "renderers/technique_registry.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::renderers {

// The storm before air, ground and sky are added, in the pixels of the eye buffer. The eye buffer
// is the picture of the storm alone. The textures are null if there is no storm.
struct SeenStorm {
  const gl::Texture2D* radiance = nullptr;  // alpha is the transmittance to the background
  // The mean distance of the visible parts of the storm from the eye, times the opacity. Null if
  // the technique does not compute it.
  const gl::Texture2D* opacity_distance_m = nullptr;
  // The box that the textures of a LightCorrection cover. A ray looks up its correction at the
  // place at that mean distance.
  volume::WorldBox box;
};

struct LinearFrame {
  // A float texture with the storm's opacity in alpha. It is valid until the next Draw.
  const gl::Texture2D* radiance = nullptr;
  // True if `radiance` has the size DrawQuality::coarse_px and chosen rays can be added.
  bool coarse = false;
  SeenStorm storm;    // valid as long as the frame
  StageTimes stages;  // the stages that ran
  Content content;
  int slices = 0;
  std::size_t device_bytes = 0;
};

// Chosen rays of a frame.
struct ChosenFrame {
  // Radiance as in LinearFrame. The pixel of each ray is ChosenRays::PixelOf.
  const gl::Texture2D* radiance = nullptr;
  // Size in pixels of the part of the texture that holds rays. The part begins at the lower left
  // pixel.
  glm::ivec2 part_px{0};
  StageTimes stages;
};

class SceneRenderer {
 public:
  using Fields = std::shared_ptr<const volume::HydrometeorFields>;
  using Registry = std::shared_ptr<const TechniqueRegistry>;

  // `programs` links the shader programs. The techniques come from `registry`. Several renderers
  // may share one registry and with it the preparations on the CPU (fits of metaballs).
  explicit SceneRenderer(
      std::shared_ptr<gl::ProgramCache> programs = std::make_shared<gl::ProgramCache>(),
      Registry registry = std::make_shared<TechniqueRegistry>(TechniqueRegistry::BuiltIn()));

  // Returns the first stage that Draw would run for `scene` with the quality of the last call.
  scene::Stage FirstStage(const scene::Scene& scene, const Fields& fields) const;

  // Draws `scene` from `fields`, which are those of its storm and time. Returns INVALID_ARGUMENT if
  // the technique is not registered or cannot be drawn, and CANCELLED if the drawing was cancelled
  // between two pieces (gl/pieces.h).
  absl::StatusOr<LinearFrame> Draw(const scene::Scene& scene, const Fields& fields,
                                   const DrawQuality& quality);

  // Draws the rays through chosen places of the last frame, which must be coarse. The result is
  // valid until the next call. Coordinates of places range from (-1, -1) at the lower left to (1,
  // 1) at the upper right.
  absl::StatusOr<ChosenFrame> DrawChosen(const std::vector<glm::vec2>& places);

  // Draws the last frame with a storm that sends out no light, so that only the air and the
  // background contribute. The last frame must not be coarse or show the sun
  // (DrawQuality::sun_seen). The next Draw redraws the view.
  absl::StatusOr<LinearFrame> DrawBehind();

  // Returns the bytes on the device.
  std::size_t Bytes() const;

 private:
  // Returns true if the last frame was coarse.
  bool DrewCoarse() const {
    return drawn_settings_.has_value() && drawn_settings_->detail_size.has_value();
  }
  // Returns true if the technique and the device can draw chosen rays of the scene.
  bool DrawsChosen() const;
  // Returns the scene's technique, which is created on first use.
  absl::StatusOr<Technique*> Choose(const scene::Scene& scene);
  scene::Stage FirstStageAt(const scene::Scene& scene, const Fields& fields,
                            const DrawQuality& quality) const;
  absl::Status MakeContent(const scene::Scene& scene, const Fields& fields, bool quick_water_paths,
                           StageTimes* times);
  // Returns true if the scene differs from the drawn scene, up to the light stage, only in lights
  // other than the sun.
  bool OnlyLightsDiffer(scene::Scene scene, const Fields& fields) const;
  // Records the inputs of the kept results, and marks the view as not drawn.
  void Keep(const scene::Scene& scene, const Fields& fields, const DrawQuality& quality);
  // Draws the storm's view after its light was computed. Returns the part of the eye buffer that
  // may show the storm (cover.h), or null if this can be all of it.
  absl::StatusOr<const Cover*> DrawContent(const scene::Scene& scene, RenderSettings& settings,
                                           StageTimes* times);
  // Draws the storm's shadow on the ground, if it has changed and the technique does not draw it.
  // Unless the rays are drawn as chosen rays (`packed`, see DrawPacked), it also draws the distance
  // of the ground where ground may hide a part of the storm.
  absl::Status DrawGround(RenderSettings* settings, bool packed, StageTimes* times);
  absl::Status ShadeAir(const scene::Scene& scene, const RenderSettings& settings,
                        StageTimes* times);
  const gl::Texture2D& Eye() const;
  // Returns the bounding box of what was drawn.
  volume::WorldBox Box() const;
  // Marks where the medium may be in a picture of `size_px` and returns `cover`. Returns null if
  // the technique also draws elsewhere. `margin_px` is how far the drawn medium spreads beyond its
  // bricks.
  absl::StatusOr<const Cover*> CoverOf(const scene::View& view, const glm::ivec2& size_px,
                                       double margin_px, Cover* cover);
  absl::Status Composite(const scene::Scene& scene, const RenderSettings& settings,
                         const glm::ivec2& size_px);
  // Adds the sun to a composed frame.
  absl::Status AddSun(const scene::Scene& scene, const scene::View& view,
                      const SunGlow::Picture& picture);
  // Draws the rays of chosen_, which are rays of the picture that `settings` describes.
  absl::Status DrawRays(const scene::Scene& scene, RenderSettings settings, StageTimes* times);
  // Draws all rays of a coarse picture as chosen rays, and copies them to their pixels.
  absl::Status DrawPacked(const scene::Scene& scene, const RenderSettings& settings,
                          StageTimes* times);
  LinearFrame Report(const scene::Scene& scene, const volume::HydrometeorFields& fields) const;

  Workspace workspace_;
  Registry registry_;
  std::map<std::string, std::unique_ptr<Technique>, std::less<>> techniques_;
  Technique* technique_ = nullptr;  // technique of the last Draw
  Cover eye_cover_;                 // cover of the medium in the eye buffer
  Cover picture_cover_;  // cover of the medium in a picture whose size differs from the eye buffer
  CoveredTarget linear_;
  ChosenRays chosen_;
  CoveredTarget chosen_linear_;
  gl::WholeTarget whole_target_;
  SunGlow sun_glow_;
  gl::Texture2D nothing_;  // an eye buffer that shows no medium

  // Inputs of the kept results.
  std::optional<scene::Scene> drawn_scene_;
  std::weak_ptr<const volume::HydrometeorFields> drawn_fields_;
  DrawQuality drawn_quality_;
  bool view_is_drawn_ = false;  // false if no view is drawn, or its drawing was cancelled
  // Quality of the light that is kept.
  double drawn_light_tolerance_ = kLightTolerance;
  double drawn_light_layer_ = 1.0;
  bool drawn_light_in_turns_ = false;
  std::optional<RenderSettings> drawn_settings_;  // settings of the last frame's view
  int drawn_slices_ = 0;
  bool sunlight_changed_ = true;  // true if the sunlight differs from that of the previous frame
};

}  // namespace thunderhead::renderers
