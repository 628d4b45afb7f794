// From a scene and a storm's fields to a linear frame: keeps each stage's result and reruns from
// the first stage that a change dirties. Owns GL objects: use it on the context's thread.
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

// The storm before air, ground and sky, in the pixels of the eye buffer. None if there is none.
struct SeenStorm {
  const gl::Texture2D* radiance = nullptr;  // and in alpha the transmittance to the background
  // The mean distance of what is seen, times the opacity; none if the technique does not know it.
  const gl::Texture2D* opacity_distance_m = nullptr;
  // Corrections of light are looked up by the place at that distance in this box.
  volume::WorldBox box;
};

struct LinearFrame {
  // Float, the storm's opacity in alpha; lives until the next Draw.
  const gl::Texture2D* radiance = nullptr;
  // `radiance` has DrawQuality::coarse_px: chosen rays may add to it.
  bool coarse = false;
  SeenStorm storm;    // as long-lived
  StageTimes stages;  // those that ran
  Content content;
  int slices = 0;
  std::size_t device_bytes = 0;
};

// Chosen rays of a frame.
struct ChosenFrame {
  const gl::Texture2D* radiance = nullptr;  // as LinearFrame's, where ChosenRays::PixelOf says
  glm::ivec2 part_px{0};                    // that rays are in, from the lowest left pixel
  StageTimes stages;
};

class SceneRenderer {
 public:
  using Fields = std::shared_ptr<const volume::HydrometeorFields>;
  using Registry = std::shared_ptr<const TechniqueRegistry>;

  // Programs are linked in `programs`; the techniques are those of `registry`, whose work on the
  // CPU (metaballs) several renderers may share.
  explicit SceneRenderer(
      std::shared_ptr<gl::ProgramCache> programs = std::make_shared<gl::ProgramCache>(),
      Registry registry = std::make_shared<TechniqueRegistry>(TechniqueRegistry::BuiltIn()));

  // The first stage that Draw would rerun, at the quality of the last one.
  scene::Stage FirstStage(const scene::Scene& scene, const Fields& fields) const;

  // Draws `scene` from the fields of its storm and time. INVALID_ARGUMENT for a technique that is
  // not registered or cannot be drawn.
  absl::StatusOr<LinearFrame> Draw(const scene::Scene& scene, const Fields& fields,
                                   const DrawQuality& quality);

  // Draws the rays of chosen places of the frame drawn last, which must be coarse; the result lives
  // until the next. Places run from (-1, -1), left and bottom, to (1, 1).
  absl::StatusOr<ChosenFrame> DrawChosen(const std::vector<glm::vec2>& places);

  // The frame drawn last, which must be neither coarse nor with the sun (DrawQuality::sun_seen),
  // with a black storm in its place: the air and what is behind. The next Draw draws the view
  // again.
  absl::StatusOr<LinearFrame> DrawBehind();

  // On the device.
  std::size_t Bytes() const;

 private:
  // True if the last frame was coarse.
  bool DrewCoarse() const {
    return drawn_settings_.has_value() && drawn_settings_->detail_size.has_value();
  }
  // True where the technique and the device draw chosen rays of the scene.
  bool DrawsChosen() const;
  // The scene's technique, made if it was not used before.
  absl::StatusOr<Technique*> Choose(const scene::Scene& scene);
  scene::Stage FirstStageAt(const scene::Scene& scene, const Fields& fields,
                            const DrawQuality& quality) const;
  absl::Status MakeContent(const scene::Scene& scene, const Fields& fields, bool quick_water_paths,
                           StageTimes* times);
  // Nothing but lights besides the sun differs up to the stage of light.
  bool OnlyLightsDiffer(scene::Scene scene, const Fields& fields) const;
  // Notes what is kept for the next picture: all but the view.
  void Keep(const scene::Scene& scene, const Fields& fields, const DrawQuality& quality);
  // Draws the view, whose light is carried. Returns the eye buffer's cover, if any.
  absl::StatusOr<const Cover*> DrawContent(const scene::Scene& scene, RenderSettings& settings,
                                           StageTimes* times);
  // The storm's shadow and, unless rays are drawn `packed`, the distance of ground that hides a
  // part of the storm.
  absl::Status DrawGround(RenderSettings* settings, bool packed, StageTimes* times);
  absl::Status ShadeAir(const scene::Scene& scene, const RenderSettings& settings,
                        StageTimes* times);
  const gl::Texture2D& Eye() const;
  // Around what was drawn.
  volume::WorldBox Box() const;
  // Marks where the medium may be in a picture of `size_px`, if the technique draws it nowhere
  // else; `margin_px` is how far it is spread there.
  absl::StatusOr<const Cover*> CoverOf(const scene::View& view, const glm::ivec2& size_px,
                                       double margin_px, Cover* cover);
  absl::Status Composite(const scene::Scene& scene, const RenderSettings& settings,
                         const glm::ivec2& size_px);
  // Adds the sun to a composed frame.
  absl::Status AddSun(const scene::Scene& scene, const scene::View& view,
                      const SunGlow::Picture& picture);
  // Draws the rays of chosen_, of the picture that `settings` describe.
  absl::Status DrawRays(const scene::Scene& scene, RenderSettings settings, StageTimes* times);
  // Draws all rays of a coarse picture as chosen ones, and puts them in their places.
  absl::Status DrawPacked(const scene::Scene& scene, const RenderSettings& settings,
                          StageTimes* times);
  LinearFrame Report(const scene::Scene& scene, const volume::HydrometeorFields& fields) const;

  Workspace workspace_;
  Registry registry_;
  std::map<std::string, std::unique_ptr<Technique>, std::less<>> techniques_;
  Technique* technique_ = nullptr;  // of the last Draw
  Cover eye_cover_;                 // of the medium in the eye buffer
  Cover picture_cover_;             // and in a picture of another size
  CoveredTarget linear_;
  ChosenRays chosen_;
  CoveredTarget chosen_linear_;
  gl::WholeTarget whole_target_;
  SunGlow sun_glow_;
  gl::Texture2D nothing_;  // an eye buffer without medium

  // Inputs of the kept results.
  std::optional<scene::Scene> drawn_scene_;
  std::weak_ptr<const volume::HydrometeorFields> drawn_fields_;
  DrawQuality drawn_quality_;
  bool view_is_drawn_ = false;  // else drawing it was cancelled
  // Of the light as it is.
  double drawn_light_tolerance_ = kLightTolerance;
  double drawn_light_layer_ = 1.0;
  bool drawn_light_in_turns_ = false;
  std::optional<RenderSettings> drawn_settings_;  // of the last frame's view
  int drawn_slices_ = 0;
  bool sunlight_changed_ = true;  // since the frame before
};

}  // namespace thunderhead::renderers
