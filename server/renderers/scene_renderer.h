// From a scene and a storm's fields to a linear frame: keeps each stage's result and reruns from
// the first stage that a change dirties. Owns GL objects: use it on the context's thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gl/objects.h"
#include "renderers/cumulus/cumulus_renderer.h"
#include "renderers/half_angle/half_angle_renderer.h"
#include "renderers/light_volume/light_volume_renderer.h"
#include "renderers/medium.h"
#include "renderers/metaball/ball_fit.h"
#include "renderers/metaball/metaball_renderer.h"
#include "renderers/sky_and_ground.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::renderers {

// Wall time of one stage: "extinction", "upload"; "fit" of metaballs; "surface" of a cumulus;
// "slices" of half-angle slicing, or "light" and "view" of the others; "ground", "composite".
struct StageTime {
  std::string stage;
  double milliseconds = 0.0;
};

struct LinearFrame {
  // RGBA float; lives until the next Draw. None where places were asked for.
  const gl::Texture2D* radiance = nullptr;
  // Only if DrawQuality::places asked for it, and as long-lived: for each pixel of the eye buffer
  // the point in the medium's box, 0 to 1 on each axis, where its correction is looked up, and in
  // alpha the transmittance to the background.
  const gl::Texture2D* places = nullptr;
  std::vector<StageTime> stages;  // those that ran
  std::vector<physics::Hydrometeor> fields;
  int slices = 0;
  std::size_t device_bytes = 0;
  double occupied_share = 0.0;
  int balls = 0;                       // metaballs drawn
  double fit_error = 0.0;              // of those, root mean square over the extinction's own
  int ellipsoids = 0;                  // of a cumulus
  std::vector<std::string> not_shown;  // what the scene asks for and the renderer cannot show
};

class SceneRenderer {
 public:
  // Programs are linked in `programs`, metaballs kept in `fits`, which several renderers may share.
  explicit SceneRenderer(
      std::shared_ptr<gl::ProgramCache> programs = std::make_shared<gl::ProgramCache>(),
      std::shared_ptr<BallFits> fits = std::make_shared<BallFits>());

  // The first stage that Draw would rerun, at the quality of the last one.
  scene::Stage FirstStage(const scene::Scene& scene,
                          const std::shared_ptr<const volume::HydrometeorFields>& fields) const;

  // Draws `scene` from the fields of its storm and time.
  absl::StatusOr<LinearFrame> Draw(const scene::Scene& scene,
                                   const std::shared_ptr<const volume::HydrometeorFields>& fields,
                                   const DrawQuality& quality);

  // On the device.
  std::size_t Bytes() const;

 private:
  // Makes what the renderer draws: the medium, or the surface of a cumulus.
  absl::Status MakeContent(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                           std::vector<StageTime>* stages);
  bool Empty() const;
  // True if what sunlight does is as it was drawn: only lights besides the sun may differ up to the
  // stage of light.
  bool OnlyLightsDiffer(scene::Scene scene,
                        const std::shared_ptr<const volume::HydrometeorFields>& fields) const;
  // The storm's shadow, and what of the storm the ground hides.
  absl::Status DrawGround(RenderSettings* settings, std::vector<StageTime>* stages);
  // Gives the ground the shadow that the light volume has found.
  void ShareShadow(const glm::dvec3& towards_sun);
  // The metaballs of the scene, if it is drawn by them.
  absl::Status FitMetaballs(const scene::Scene& scene,
                            const std::shared_ptr<const volume::HydrometeorFields>& fields,
                            std::vector<StageTime>* stages);
  // Reruns what `first` dirties of the light and the view; appends the times of what ran.
  absl::Status DrawMedium(const RenderSettings& settings, scene::Stage first,
                          std::vector<StageTime>* stages);
  // Reruns what `first` dirties of a cumulus.
  absl::Status DrawCumulus(const scene::Scene& scene, RenderSettings* settings, scene::Stage first,
                           std::vector<StageTime>* stages);
  const gl::Texture2D& Eye() const;
  // Around what was drawn.
  volume::WorldBox Box() const;
  // Marks where the medium may be in a picture of `size_px`, if the renderer draws it nowhere else;
  // `margin_px` is how far it is spread there.
  absl::StatusOr<const Cover*> CoverOf(const scene::View& view, const glm::ivec2& size_px,
                                       double margin_px, Cover* cover);
  absl::Status Composite(const scene::Scene& scene, const scene::View& view, GLenum format,
                         const Cover* eye_cover);
  LinearFrame Report(const scene::Scene& scene, const volume::HydrometeorFields& fields) const;

  std::shared_ptr<gl::ProgramCache> programs_;
  SkyAndGround surroundings_;
  Ground ground_;
  HalfAngleRenderer half_angle_;
  LightVolumeRenderer light_volume_;
  std::shared_ptr<BallFits> fits_;
  std::shared_ptr<const BallCloud> balls_;
  MetaballRenderer metaball_;
  CumulusRenderer cumulus_;
  scene::Renderer drawn_by_ = scene::Renderer::kHalfAngle;
  std::vector<physics::Hydrometeor> cumulus_fields_;  // that the surface was made of
  DetailNoises detail_noises_;
  ResidentMedium medium_;
  Cover eye_cover_;      // of the medium in the eye buffer
  Cover picture_cover_;  // and in a picture of another size
  CoveredTarget linear_;
  gl::Texture2D nothing_;  // an eye buffer without medium

  // What the kept results were drawn from.
  std::optional<scene::Scene> drawn_scene_;
  std::weak_ptr<const volume::HydrometeorFields> drawn_fields_;
  DrawQuality drawn_quality_;
  int drawn_slices_ = 0;
  bool sunlight_changed_ = true;  // since the frame before
};

}  // namespace thunderhead::renderers
