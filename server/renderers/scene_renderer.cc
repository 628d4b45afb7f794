#include "renderers/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/status.h"
#include "base/stopwatch.h"
#include "renderers/cumulus/surface_of_scene.h"
#include "scene/view.h"

namespace thunderhead::renderers {
namespace {

glm::ivec2 EyeSize(const scene::Scene& scene, const DrawQuality& quality) {
  const glm::dvec2 size(scene.output.width_px, scene.output.height_px);
  const double scale = scene.rendering.image_scale * quality.image_scale;
  return glm::max(glm::ivec2(glm::ceil(size * scale)), glm::ivec2(1));
}

std::vector<std::string> NotShownByMetaballs(const scene::Rendering& rendering) {
  std::vector<std::string> not_shown = {"structure finer than the metaballs"};
  if (scene::HasDetail(rendering.mode)) not_shown.emplace_back("turbulent detail");
  if (rendering.transport == scene::Transport::kPaper) {
    not_shown.emplace_back("the fields' albedo, phase functions and false colours");
    not_shown.emplace_back("modes");
  }
  if (rendering.transport == scene::Transport::kDiffusion) {
    not_shown.emplace_back("diffusion transport (it is drawn as consistent)");
  }
  return not_shown;
}

void SayIfLightIsNotTraced(const scene::Scene& scene, std::vector<std::string>* not_shown) {
  if (!scene.rendering.traced_light || scene::ShowsTracedLight(scene.rendering)) return;
  not_shown->emplace_back("traced light (the light volume with diffusion transport shows it)");
}

void SayWhichLights(const scene::Scene& scene, std::vector<std::string>* not_shown) {
  if (scene.lights.empty() || scene::ShowsLights(scene.rendering.renderer)) return;
  not_shown->emplace_back("lights besides the sun (metaballs and the reference show them)");
}

}  // namespace

SceneRenderer::SceneRenderer(std::shared_ptr<gl::ProgramCache> programs,
                             std::shared_ptr<BallFits> fits)
    : programs_(std::move(programs)),
      surroundings_(programs_),
      ground_(programs_),
      half_angle_(programs_),
      light_volume_(programs_),
      fits_(std::move(fits)),
      metaball_(programs_),
      cumulus_(programs_),
      eye_cover_(programs_),
      picture_cover_(programs_) {}

scene::Stage SceneRenderer::FirstStage(
    const scene::Scene& scene,
    const std::shared_ptr<const volume::HydrometeorFields>& fields) const {
  if (!drawn_scene_.has_value() || drawn_fields_.lock() != fields) return scene::Stage::kStorm;
  return scene::FirstDirtyStage(*drawn_scene_, scene);
}

bool SceneRenderer::OnlyLightsDiffer(
    scene::Scene scene, const std::shared_ptr<const volume::HydrometeorFields>& fields) const {
  if (drawn_scene_.has_value()) scene.lights = drawn_scene_->lights;
  return FirstStage(scene, fields) > scene::Stage::kLight;
}

std::size_t SceneRenderer::Bytes() const {
  return medium_.Bytes() + half_angle_.Bytes() + light_volume_.Bytes() + metaball_.Bytes() +
         cumulus_.Bytes() + surroundings_.Bytes() + ground_.Bytes() + linear_.Texture().Bytes() +
         eye_cover_.Bytes() + picture_cover_.Bytes();
}

absl::StatusOr<LinearFrame> SceneRenderer::Draw(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
    const DrawQuality& quality) {
  scene::Stage first = FirstStage(scene, fields);
  sunlight_changed_ = first <= scene::Stage::kLight && !OnlyLightsDiffer(scene, fields);
  if (quality != drawn_quality_) first = std::min(first, scene::Stage::kView);
  if (quality.light_detail != drawn_quality_.light_detail ||
      quality.single_precision != drawn_quality_.single_precision) {
    first = std::min(first, scene::Stage::kLight);
  }
  drawn_scene_.reset();
  std::vector<StageTime> stages;
  drawn_by_ = scene.rendering.renderer;
  if (first <= scene::Stage::kExtinction) {
    THUNDERHEAD_RETURN_IF_ERROR(MakeContent(scene, *fields, &stages));
  }
  if (first <= scene::Stage::kView) {
    const scene::View view = scene::ViewOf(scene, *fields);
    if (first <= scene::Stage::kStorm) ground_.SetTerrain(*fields);
    surroundings_.Update(scene, view, ground_);
    ground_.SetCorrection(quality.correction);
    drawn_slices_ = 0;
    const Cover* cover = nullptr;
    if (!Empty()) {
      const double wanted = std::ceil(scene.rendering.slices * quality.slice_share);
      drawn_slices_ = std::max(static_cast<int>(wanted), 1);
      RenderSettings settings{
          scene.rendering,         view,          surroundings_.IlluminationOf(scene),
          EyeSize(scene, quality), drawn_slices_, quality};
      if (drawn_by_ == scene::Renderer::kCumulus) {
        THUNDERHEAD_RETURN_IF_ERROR(DrawCumulus(scene, &settings, first, &stages));
      } else {
        THUNDERHEAD_RETURN_IF_ERROR(DrawGround(&settings, &stages));
        if (first <= scene::Stage::kLight) {
          THUNDERHEAD_RETURN_IF_ERROR(FitMetaballs(scene, fields, &stages));
        }
        THUNDERHEAD_ASSIGN_OR_RETURN(cover, CoverOf(view, settings.eye_size, 1.0, &eye_cover_));
        settings.cover = cover;
        THUNDERHEAD_RETURN_IF_ERROR(DrawMedium(settings, first, &stages));
      }
    } else {
      ground_.ClearShadow();
    }
    if (!quality.places) {
      base::Stopwatch stopwatch;
      THUNDERHEAD_RETURN_IF_ERROR(
          Composite(scene, view, quality.single_precision ? GL_RGBA32F : GL_RGBA16F, cover));
      glFinish();
      stages.push_back({"composite", stopwatch.ElapsedMs()});
    }
  }
  drawn_scene_ = scene;
  drawn_fields_ = fields;
  drawn_quality_ = quality;
  LinearFrame frame = Report(scene, *fields);
  if (quality.places) {
    frame.radiance = nullptr;
    frame.places = &Eye();
  }
  frame.stages = std::move(stages);
  return frame;
}

absl::Status SceneRenderer::MakeContent(const scene::Scene& scene,
                                        const volume::HydrometeorFields& fields,
                                        std::vector<StageTime>* stages) {
  medium_ = ResidentMedium();
  cumulus_.SetSurface({});
  if (drawn_by_ == scene::Renderer::kCumulus) {
    const base::Stopwatch stopwatch;
    THUNDERHEAD_ASSIGN_OR_RETURN(const DrawnSurface drawn, SurfaceOf(scene, fields));
    cumulus_.SetSurface(drawn.surface);
    cumulus_fields_ = drawn.fields;
    stages->push_back({"surface", stopwatch.ElapsedMs()});
    return absl::OkStatus();
  }
  ResidentMedium::Cost cost;
  medium_ = ResidentMedium(scene, fields, &detail_noises_, &cost);
  stages->push_back({"extinction", cost.extinction_ms});
  stages->push_back({"upload", cost.upload_ms});
  return absl::OkStatus();
}

bool SceneRenderer::Empty() const {
  return drawn_by_ == scene::Renderer::kCumulus ? cumulus_.Empty() : medium_.Empty();
}

absl::Status SceneRenderer::DrawCumulus(const scene::Scene& scene, RenderSettings* settings,
                                        scene::Stage first, std::vector<StageTime>* stages) {
  base::Stopwatch stopwatch;
  if (first <= scene::Stage::kLight) {
    THUNDERHEAD_RETURN_IF_ERROR(cumulus_.CastShadow(*settings));
    ground_.ClearShadow();
    if (settings->illumination.towards_sun.z > 0.0) {
      THUNDERHEAD_ASSIGN_OR_RETURN(gl::Texture2D shadow, cumulus_.GroundShadow());
      ground_.TakeShadow(std::move(shadow), cumulus_.ShadowFrame(), cumulus_.Middle_m());
    }
    glFinish();
    stages->push_back({"light", stopwatch.Restart()});
  }
  if (ground_.MayHide(settings->view)) {
    THUNDERHEAD_RETURN_IF_ERROR(ground_.DrawDistance(settings->view, settings->eye_size));
    settings->ground_distance = &ground_.Distance();
    glFinish();
    stages->push_back({"ground", stopwatch.Restart()});
  }
  THUNDERHEAD_RETURN_IF_ERROR(
      cumulus_.DrawView(*settings, surroundings_.LightMap(scene), &detail_noises_));
  glFinish();
  stages->push_back({"view", stopwatch.Restart()});
  return absl::OkStatus();
}

absl::Status SceneRenderer::DrawGround(RenderSettings* settings, std::vector<StageTime>* stages) {
  // The light volume brings its own.
  const bool casts = sunlight_changed_ && drawn_by_ != scene::Renderer::kLightVolume;
  const bool may_hide = ground_.MayHide(settings->view);
  if (!casts && !may_hide) return absl::OkStatus();
  base::Stopwatch stopwatch;
  if (casts) {
    THUNDERHEAD_RETURN_IF_ERROR(ground_.CastShadow(medium_, *settings));
  }
  if (may_hide) {
    THUNDERHEAD_RETURN_IF_ERROR(ground_.DrawDistance(settings->view, settings->eye_size));
    settings->ground_distance = &ground_.Distance();
  }
  glFinish();
  stages->push_back({"ground", stopwatch.ElapsedMs()});
  return absl::OkStatus();
}

void SceneRenderer::ShareShadow(const glm::dvec3& towards_sun) {
  if (towards_sun.z <= 0.0) return ground_.ClearShadow();
  ground_.ShareShadow(&light_volume_.Shadow(), LightFrameOf({medium_.HalfExtent_m()}, towards_sun),
                      medium_.Middle_m());
}

absl::Status SceneRenderer::FitMetaballs(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
    std::vector<StageTime>* stages) {
  if (scene.rendering.renderer != scene::Renderer::kMetaball) return absl::OkStatus();
  const bool kept = fits_->Has(scene, fields);
  const base::Stopwatch stopwatch;
  THUNDERHEAD_ASSIGN_OR_RETURN(balls_, fits_->Get(scene, fields));
  if (!kept) stages->push_back({"fit", stopwatch.ElapsedMs()});
  return absl::OkStatus();
}

absl::Status SceneRenderer::DrawMedium(const RenderSettings& settings, scene::Stage first,
                                       std::vector<StageTime>* stages) {
  base::Stopwatch stopwatch;
  const auto ran = [&](const char* stage) {
    glFinish();
    stages->push_back({stage, stopwatch.Restart()});
  };
  const bool light_changed = first <= scene::Stage::kLight;
  switch (settings.rendering.renderer) {
    case scene::Renderer::kHalfAngle:
      THUNDERHEAD_RETURN_IF_ERROR(half_angle_.Render(medium_, settings, light_changed));
      ran("slices");
      break;
    case scene::Renderer::kLightVolume:
      if (light_changed) {
        THUNDERHEAD_RETURN_IF_ERROR(light_volume_.CarryLight(medium_, settings));
        ShareShadow(settings.illumination.towards_sun);
        ran("light");
      }
      THUNDERHEAD_RETURN_IF_ERROR(light_volume_.DrawView(medium_, settings));
      ran("view");
      break;
    case scene::Renderer::kMetaball:
      if (light_changed) {
        THUNDERHEAD_RETURN_IF_ERROR(metaball_.CarryLight(*balls_, medium_.Content(), settings));
        ran("light");
      }
      THUNDERHEAD_RETURN_IF_ERROR(metaball_.DrawView(settings));
      ran("view");
      break;
    case scene::Renderer::kReference:
      return absl::InvalidArgumentError("the reference is traced, not drawn");
    case scene::Renderer::kCumulus:
      return absl::InternalError("a cumulus has no medium");
  }
  return absl::OkStatus();
}

const gl::Texture2D& SceneRenderer::Eye() const {
  if (Empty()) return nothing_;
  switch (drawn_by_) {
    case scene::Renderer::kHalfAngle:
      return half_angle_.Eye();
    case scene::Renderer::kCumulus:
      return cumulus_.Eye();
    case scene::Renderer::kMetaball:
      return metaball_.Eye();
    case scene::Renderer::kLightVolume:
    case scene::Renderer::kReference:
      break;
  }
  return light_volume_.Eye();
}

volume::WorldBox SceneRenderer::Box() const {
  if (Empty()) return {};
  if (drawn_by_ == scene::Renderer::kCumulus) {
    return {cumulus_.Middle_m() - cumulus_.HalfExtent_m(),
            cumulus_.Middle_m() + cumulus_.HalfExtent_m()};
  }
  if (drawn_by_ == scene::Renderer::kMetaball && !metaball_.Box().Empty()) {
    return {metaball_.Box().low_m, metaball_.Box().high_m};
  }
  return {medium_.Middle_m() - medium_.HalfExtent_m(), medium_.Middle_m() + medium_.HalfExtent_m()};
}

absl::StatusOr<const Cover*> SceneRenderer::CoverOf(const scene::View& view,
                                                    const glm::ivec2& size_px, double margin_px,
                                                    Cover* cover) {
  if (drawn_by_ != scene::Renderer::kHalfAngle && drawn_by_ != scene::Renderer::kLightVolume) {
    return nullptr;
  }
  THUNDERHEAD_RETURN_IF_ERROR(cover->Draw(medium_.OccupiedBoxes(), view, size_px, margin_px));
  return cover;
}

absl::Status SceneRenderer::Composite(const scene::Scene& scene, const scene::View& view,
                                      GLenum format, const Cover* eye_cover) {
  const glm::ivec2 size_px(scene.output.width_px, scene.output.height_px);
  if (nothing_.Get() == 0) {
    nothing_ = gl::Texture2D(GL_RGBA16F, glm::ivec2(1));
    gl::Framebuffer(nothing_).Clear(0.0F, 0.0F, 0.0F, 1.0F);
  }
  const Cover* cover = eye_cover;
  if (cover == nullptr || Eye().Size() != size_px) {
    // A pixel takes in the eye buffer's pixels around it.
    const double margin_px = 1.0 + std::ceil(static_cast<double>(size_px.x) / Eye().Size().x);
    THUNDERHEAD_ASSIGN_OR_RETURN(cover, CoverOf(view, size_px, margin_px, &picture_cover_));
  }
  linear_.Resize(format, size_px, cover);
  return surroundings_.Composite(scene, view, ground_, Box(), Eye(), linear_, cover);
}

LinearFrame SceneRenderer::Report(const scene::Scene& scene,
                                  const volume::HydrometeorFields& fields) const {
  LinearFrame frame;
  frame.radiance = &linear_.Texture();
  frame.fields = medium_.Content().hydrometeors;
  frame.slices = drawn_slices_;
  frame.device_bytes = Bytes();
  if (drawn_by_ == scene::Renderer::kCumulus) {
    frame.fields = cumulus_fields_;
    frame.slices = 0;
    frame.ellipsoids = cumulus_.BubbleCount();
    frame.not_shown = NotShownByCumulus(scene, fields);
    SayWhichLights(scene, &frame.not_shown);
    SayIfLightIsNotTraced(scene, &frame.not_shown);
    return frame;
  }
  if (!medium_.Empty()) {
    const glm::dvec3 box_m = 2.0 * medium_.HalfExtent_m();
    const glm::dvec3 domain_m = fields.grid.HighCorner_m() - fields.grid.low_corner_m;
    const bool leaps = drawn_by_ != scene::Renderer::kMetaball;
    frame.occupied_share = (leaps ? medium_.OccupiedShare() : 1.0) * box_m.x * box_m.y * box_m.z /
                           (domain_m.x * domain_m.y * domain_m.z);
  }
  if (scene.rendering.renderer == scene::Renderer::kMetaball) {
    frame.slices = 0;
    if (!medium_.Empty()) {
      frame.balls = static_cast<int>(balls_->balls.size());
      frame.fit_error = balls_->relative_error;
    }
    frame.not_shown = NotShownByMetaballs(scene.rendering);
  }
  SayWhichLights(scene, &frame.not_shown);
  SayIfLightIsNotTraced(scene, &frame.not_shown);
  return frame;
}

}  // namespace thunderhead::renderers
