#include "renderers/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "gl/whole_target.h"
#include "scene/ground.h"
#include "scene/view.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

// Coarse frames use air shade of a higher resolution: that for a picture larger by this factor
// along each side.
constexpr float kCoarseAirScale = 1.4F;

constexpr gl::PieceCost kUnpackedPixel{"unpacked", 10.0};

glm::ivec2 EyeSize(const scene::Scene& scene, const DrawQuality& quality) {
  const glm::dvec2 size(scene.output.width_px, scene.output.height_px);
  const double scale = scene.rendering.image_scale * quality.image_scale;
  return glm::max(glm::ivec2(glm::ceil(size * scale)), glm::ivec2(1));
}

// Returns true if a picture of this size has too few tiles to keep all threads of software GL busy.
// One thread then takes longer for a tile than all threads would take for evenly shared pixels.
bool LeavesThreadsIdle(const glm::ivec2& size_px) {
  constexpr int kTileSide = 64;
  constexpr unsigned kMaxThreads = 16;
  static const unsigned threads = std::min(std::thread::hardware_concurrency(), kMaxThreads);
  const glm::ivec2 tile = glm::min(size_px, glm::ivec2(kTileSide));
  return static_cast<std::int64_t>(tile.x) * tile.y * threads >
         static_cast<std::int64_t>(size_px.x) * size_px.y;
}

// Returns the number of slices at this quality, or 0 if the technique has no slices.
int SlicesAt(const scene::Scene& scene, const DrawQuality& quality) {
  const std::optional<int> slices = scene::SlicesOf(scene.rendering.technique);
  if (!slices.has_value()) return 0;
  return std::max(static_cast<int>(std::ceil(*slices * quality.slice_share)), 1);
}

absl::Status UnknownTechnique(std::string_view name, const TechniqueRegistry& registry) {
  std::string known;
  for (const auto& technique : registry.All()) {
    if (!technique->Capabilities().images) continue;
    absl::StrAppend(&known, known.empty() ? "" : ", ", std::string(technique->Name()));
  }
  return absl::InvalidArgumentError(absl::StrCat("no renderer draws the technique '",
                                                 std::string(name), "'; choose one of: ", known));
}

}  // namespace

SceneRenderer::SceneRenderer(std::shared_ptr<gl::ProgramCache> programs, Registry registry)
    : workspace_(std::move(programs)),
      registry_(std::move(registry)),
      eye_cover_(workspace_.programs),
      picture_cover_(workspace_.programs),
      sun_glow_(workspace_.programs) {}

scene::Stage SceneRenderer::FirstStage(const scene::Scene& scene, const Fields& fields) const {
  if (!drawn_scene_.has_value() || drawn_fields_.lock() != fields) return scene::Stage::kStorm;
  return scene::FirstDirtyStage(*drawn_scene_, scene);
}

scene::Stage SceneRenderer::FirstStageAt(const scene::Scene& scene, const Fields& fields,
                                         const DrawQuality& quality) const {
  const scene::Stage first = FirstStage(scene, fields);
  if (workspace_.medium.HasQuickWaterPaths() && !quality.quick_water_paths) {
    return std::min(first, scene::Stage::kExtinction);
  }
  if (quality.light_detail != drawn_quality_.light_detail ||
      quality.light_tolerance < drawn_light_tolerance_ ||
      quality.light_layer < drawn_light_layer_ ||
      (drawn_light_in_turns_ && !quality.light_in_turns) ||
      quality.single_precision != drawn_quality_.single_precision) {
    return std::min(first, scene::Stage::kLight);
  }
  const bool as_before = view_is_drawn_ && quality == drawn_quality_;
  return as_before ? first : std::min(first, scene::Stage::kView);
}

bool SceneRenderer::OnlyLightsDiffer(scene::Scene scene, const Fields& fields) const {
  if (drawn_scene_.has_value()) scene.lights = drawn_scene_->lights;
  return FirstStage(scene, fields) > scene::Stage::kLight;
}

std::size_t SceneRenderer::Bytes() const {
  std::size_t bytes = workspace_.medium.Bytes() + workspace_.surroundings.Bytes() +
                      workspace_.ground.Bytes() + workspace_.ground_cover.Bytes() +
                      linear_.Texture().Bytes() + chosen_.Bytes() +
                      chosen_linear_.Texture().Bytes() + eye_cover_.Bytes() +
                      picture_cover_.Bytes() + sun_glow_.Bytes();
  for (const auto& [name, technique] : techniques_) bytes += technique->Bytes();
  return bytes;
}

absl::StatusOr<Technique*> SceneRenderer::Choose(const scene::Scene& scene) {
  const std::string_view name = scene::NameOf(scene.rendering.technique);
  if (const auto made = techniques_.find(name); made != techniques_.end()) {
    return made->second.get();
  }
  const TechniqueFactory* factory = registry_->Find(name);
  if (factory == nullptr) return UnknownTechnique(name, *registry_);
  std::unique_ptr<Technique> technique = factory->Make(workspace_);
  if (technique == nullptr) return UnknownTechnique(name, *registry_);
  return techniques_.emplace(name, std::move(technique)).first->second.get();
}

absl::StatusOr<LinearFrame> SceneRenderer::Draw(const scene::Scene& asked, const Fields& fields,
                                                const DrawQuality& quality) {
  const scene::Scene scene = scene::WithGroundOf(asked, *fields);
  const scene::Stage first = FirstStageAt(asked, fields, quality);
  sunlight_changed_ = first <= scene::Stage::kLight && !OnlyLightsDiffer(asked, fields);
  drawn_scene_.reset();
  if (first <= scene::Stage::kView) drawn_settings_.reset();
  if (first <= scene::Stage::kLight) {
    drawn_light_tolerance_ = quality.light_tolerance;
    drawn_light_layer_ = quality.light_layer;
    drawn_light_in_turns_ = quality.light_in_turns;
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(technique_, Choose(scene));
  StageTimes times;
  if (first <= scene::Stage::kExtinction) {
    // After a change of fields, water paths are computed in full immediately. A frame at rest would
    // need them anyway.
    const bool quick = quality.quick_water_paths && first > scene::Stage::kStorm;
    THUNDERHEAD_RETURN_IF_ERROR(MakeContent(scene, fields, quick, &times));
  }
  if (first <= scene::Stage::kView) {
    const scene::View view = scene::ViewOf(scene, *fields);
    if (first <= scene::Stage::kStorm) {
      workspace_.ground.SetTerrain(*fields);
      workspace_.ground_cover.SetLand(*fields);
    }
    workspace_.ground_cover.Prepare(scene, *fields);
    workspace_.surroundings.Update(scene, view, workspace_.ground);
    workspace_.ground.SetCorrection(quality.correction);
    drawn_slices_ = 0;
    const glm::ivec2 picture_px(scene.output.width_px, scene.output.height_px);
    RenderSettings settings{.technique = scene.rendering.technique,
                            .view = view,
                            .eye_size = EyeSize(scene, quality),
                            .quality = quality};
    const bool coarse = quality.coarse_px.has_value() && DrawsChosen();
    if (coarse) {
      settings.detail_size = picture_px;
      settings.eye_size = *quality.coarse_px;
    }
    const bool packed = coarse && LeavesThreadsIdle(settings.eye_size);
    if (!technique_->Empty()) {
      settings.slices = drawn_slices_ = SlicesAt(scene, quality);
      settings.illumination = workspace_.surroundings.IlluminationOf(scene);
      if (first <= scene::Stage::kLight) {
        THUNDERHEAD_RETURN_IF_ERROR(technique_->CarryLight(scene, fields, settings, &times));
      }
      THUNDERHEAD_RETURN_IF_ERROR(DrawGround(&settings, packed, &times));
      // The inputs are recorded now. If drawing is cancelled after this point, the next picture
      // need not propagate the light again.
      Keep(asked, fields, quality);
      if (!packed) {
        THUNDERHEAD_ASSIGN_OR_RETURN(settings.cover, DrawContent(scene, settings, &times));
      }
    } else {
      workspace_.ground.ClearShadow();
    }
    THUNDERHEAD_RETURN_IF_ERROR(ShadeAir(scene, settings, &times));
    if (packed) {
      THUNDERHEAD_RETURN_IF_ERROR(DrawPacked(scene, settings, &times));
    } else {
      const glm::ivec2 size_px = coarse ? *quality.coarse_px : picture_px;
      THUNDERHEAD_RETURN_IF_ERROR(Timed(workspace_.Pieces(), scene::FrameStage::kComposite, &times,
                                        [&] { return Composite(scene, settings, size_px); }));
    }
    drawn_settings_ = settings;
  }
  Keep(asked, fields, quality);
  view_is_drawn_ = true;
  LinearFrame frame = Report(scene, *fields);
  frame.coarse = DrewCoarse();
  frame.stages = std::move(times);
  return frame;
}

absl::StatusOr<LinearFrame> SceneRenderer::DrawBehind() {
  THUNDERHEAD_CHECK(drawn_settings_.has_value() && !DrewCoarse() && drawn_scene_.has_value(),
                    "a whole frame was drawn last");
  THUNDERHEAD_CHECK(!drawn_settings_->quality.sun_seen,
                    "the storm's aureole must be part of the storm's light");
  const std::shared_ptr<const volume::HydrometeorFields> fields = drawn_fields_.lock();
  THUNDERHEAD_CHECK(fields != nullptr, "the fields of the frame are gone");
  const scene::Scene scene = scene::WithGroundOf(*drawn_scene_, *fields);
  view_is_drawn_ = false;
  if (!technique_->Empty()) {
    const gl::Framebuffer eye(Eye());
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
    eye.Clear(0.0F, 0.0F, 0.0F, 0.0F);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  }
  THUNDERHEAD_RETURN_IF_ERROR(
      Composite(scene, *drawn_settings_, {scene.output.width_px, scene.output.height_px}));
  return Report(scene, *fields);
}

void SceneRenderer::Keep(const scene::Scene& scene, const Fields& fields,
                         const DrawQuality& quality) {
  drawn_scene_ = scene;
  drawn_fields_ = fields;
  drawn_quality_ = quality;
  view_is_drawn_ = false;
}

absl::Status SceneRenderer::MakeContent(const scene::Scene& scene, const Fields& fields,
                                        bool quick_water_paths, StageTimes* times) {
  // Techniques that draw the medium share it, and keep their other results. The results of all
  // other techniques belong to another scene and are freed.
  std::erase_if(techniques_, [this](const auto& entry) {
    return entry.second.get() != technique_ && !entry.second->DrawsMedium();
  });
  workspace_.medium = ResidentMedium();
  if (technique_->DrawsMedium()) {
    ResidentMedium::Cost cost;
    // This computation uses mostly the CPU, so it runs without the device turn (gl/pieces.h).
    THUNDERHEAD_RETURN_IF_ERROR(workspace_.Pieces().OffTurn([&] {
      workspace_.medium = ResidentMedium(
          scene, *fields, &workspace_.noises, &cost,
          quick_water_paths ? volume::WaterPathEffort::kQuick : volume::WaterPathEffort::kFull);
      glFinish();
    }));
    times->push_back({scene::FrameStage::kExtinction, cost.extinction_ms});
    times->push_back({scene::FrameStage::kUpload, cost.upload_ms});
  }
  return technique_->MakeContent(scene, fields, times);
}

absl::StatusOr<const Cover*> SceneRenderer::DrawContent(const scene::Scene& scene,
                                                        RenderSettings& settings,
                                                        StageTimes* times) {
  THUNDERHEAD_ASSIGN_OR_RETURN(settings.cover,
                               CoverOf(settings.view, settings.eye_size, 1.0, &eye_cover_));
  THUNDERHEAD_RETURN_IF_ERROR(technique_->DrawView(scene, settings, times));
  return settings.cover;
}

absl::Status SceneRenderer::DrawGround(RenderSettings* settings, bool packed, StageTimes* times) {
  Ground& ground = workspace_.ground;
  const bool casts = sunlight_changed_ && !technique_->CastsShadow();
  const bool may_hide = !packed && ground.MayHide(settings->view);
  if (!casts && !may_hide) return absl::OkStatus();
  return Timed(workspace_.Pieces(), scene::FrameStage::kGround, times, [&]() -> absl::Status {
    if (casts) {
      THUNDERHEAD_RETURN_IF_ERROR(ground.CastShadow(workspace_.medium, *settings));
    }
    if (may_hide) {
      THUNDERHEAD_RETURN_IF_ERROR(ground.DrawDistance(settings->view, settings->eye_size));
      settings->ground_distance = &ground.Distance();
    }
    return absl::OkStatus();
  });
}

absl::Status SceneRenderer::ShadeAir(const scene::Scene& scene, const RenderSettings& settings,
                                     StageTimes* times) {
  if (!workspace_.ground.HasShadow()) {
    workspace_.surroundings.LightAllAir();
    return absl::OkStatus();
  }
  const glm::ivec2 picture_px(scene.output.width_px, scene.output.height_px);
  return Timed(workspace_.Pieces(), scene::FrameStage::kAir, times, [&] {
    return workspace_.surroundings.ShadeAir(
        scene, settings.view, workspace_.ground, Box(), workspace_.medium,
        settings.detail_size.has_value()
            ? glm::ivec2(kCoarseAirScale * glm::vec2(settings.eye_size))
            : picture_px);
  });
}

const gl::Texture2D& SceneRenderer::Eye() const {
  return technique_->Empty() ? nothing_ : technique_->Eye();
}

volume::WorldBox SceneRenderer::Box() const {
  return technique_->Empty() ? volume::WorldBox{} : technique_->Box();
}

absl::StatusOr<const Cover*> SceneRenderer::CoverOf(const scene::View& view,
                                                    const glm::ivec2& size_px, double margin_px,
                                                    Cover* cover) {
  if (!technique_->KeepsToCover()) return nullptr;
  THUNDERHEAD_RETURN_IF_ERROR(
      cover->Draw(workspace_.medium.OccupiedBoxes(), view, size_px, margin_px));
  return cover;
}

absl::Status SceneRenderer::Composite(const scene::Scene& scene, const RenderSettings& settings,
                                      const glm::ivec2& size_px) {
  if (nothing_.Get() == 0) {
    nothing_ = gl::Texture2D(GL_RGBA16F, glm::ivec2(1));
    gl::Framebuffer(nothing_).Clear(0.0F, 0.0F, 0.0F, 1.0F);
  }
  const Cover* cover = settings.cover;
  const bool chosen = settings.chosen != nullptr;
  if (!chosen && (cover == nullptr || Eye().Size() != size_px)) {
    // A pixel of the picture reads the eye buffer's pixels around it.
    const double margin_px = 1.0 + std::ceil(static_cast<double>(size_px.x) / Eye().Size().x);
    THUNDERHEAD_ASSIGN_OR_RETURN(cover,
                                 CoverOf(settings.view, size_px, margin_px, &picture_cover_));
  }
  const DrawQuality& quality = settings.quality;
  CoveredTarget& linear = chosen ? chosen_linear_ : linear_;
  linear.Resize(quality.single_precision ? GL_RGBA32F : GL_RGBA16F, size_px, cover);
  const gl::Texture2D* distances_m = technique_->Empty() ? nullptr : technique_->Distances_m();
  THUNDERHEAD_RETURN_IF_ERROR(workspace_.surroundings.Composite(
      scene, settings.view, workspace_.ground, workspace_.ground_cover, {Eye(), distances_m, Box()},
      linear, cover, settings.chosen));
  if (!quality.sun_seen) return absl::OkStatus();
  return AddSun(scene, settings.view,
                {linear.Target(), chosen ? *settings.detail_size : size_px, settings.chosen});
}

absl::Status SceneRenderer::AddSun(const scene::Scene& scene, const scene::View& view,
                                   const SunGlow::Picture& picture) {
  const SunGlow::Sun sun = workspace_.surroundings.SunFrom(scene, view);
  const scene::MediumSettings* settings = scene::MediumSettingsOf(scene.rendering.technique);
  // Only techniques that draw the medium show an aureole. With the paper's transport, radiance is
  // on the paper's display scale, to which the aureole cannot be added.
  if (technique_->KeepsToCover() && !technique_->Empty() && settings != nullptr &&
      !scene::IsPaper(settings->transport)) {
    return sun_glow_.AddThrough(workspace_.medium, *settings, drawn_slices_, sun, view,
                                &workspace_.ground, picture);
  }
  return sun_glow_.AddBehind(Eye(), sun, view, workspace_.ground, picture);
}

bool SceneRenderer::DrawsChosen() const {
  // Devices that compute whole targets (gl/whole_target.h) draw all rays in less time than choosing
  // rays would take.
  return technique_->DrawsChosen() && !technique_->Empty() && !gl::ComputesWholeTargets();
}

absl::StatusOr<ChosenFrame> SceneRenderer::DrawChosen(const std::vector<glm::vec2>& places) {
  THUNDERHEAD_CHECK(DrewCoarse() && drawn_scene_.has_value(),
                    "rays can be chosen only for a coarse frame");
  const std::shared_ptr<const volume::HydrometeorFields> fields = drawn_fields_.lock();
  THUNDERHEAD_CHECK(fields != nullptr, "the fields of the frame are gone");
  const scene::Scene scene = scene::WithGroundOf(*drawn_scene_, *fields);
  chosen_.Choose(places);
  ChosenFrame frame;
  THUNDERHEAD_RETURN_IF_ERROR(DrawRays(scene, *drawn_settings_, &frame.stages));
  frame.radiance = &chosen_linear_.Texture();
  frame.part_px = chosen_.Rect().Size();
  return frame;
}

absl::Status SceneRenderer::DrawRays(const scene::Scene& scene, RenderSettings settings,
                                     StageTimes* times) {
  settings.chosen = &chosen_;
  settings.eye_size = chosen_.Size();
  settings.cover = nullptr;
  if (workspace_.ground.MayHide(settings.view)) {
    THUNDERHEAD_RETURN_IF_ERROR(
        workspace_.ground.DrawDistance(settings.view, settings.eye_size, &chosen_));
    settings.ground_distance = &workspace_.ground.Distance();
  }
  THUNDERHEAD_RETURN_IF_ERROR(technique_->DrawView(scene, settings, times));
  return Timed(workspace_.Pieces(), scene::FrameStage::kComposite, times,
               [&] { return Composite(scene, settings, settings.eye_size); });
}

absl::Status SceneRenderer::DrawPacked(const scene::Scene& scene, const RenderSettings& settings,
                                       StageTimes* times) {
  const glm::ivec2 size_px = settings.eye_size;
  chosen_.ChooseAll(size_px);
  THUNDERHEAD_RETURN_IF_ERROR(DrawRays(scene, settings, times));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      workspace_.programs->Get(gl::ProgramSource::WholeTarget("post/unpacked.frag")));
  linear_.Resize(settings.quality.single_precision ? GL_RGBA32F : GL_RGBA16F, size_px, nullptr);
  program->Set(uniform::picture_size, size_px);
  chosen_linear_.Texture().Bind(shaders::kPackedUnit);
  return whole_target_.Draw(workspace_.Pieces(), kUnpackedPixel, *program, linear_.Target());
}

LinearFrame SceneRenderer::Report(const scene::Scene& scene,
                                  const volume::HydrometeorFields& fields) const {
  LinearFrame frame;
  frame.radiance = &linear_.Texture();
  if (!technique_->Empty()) frame.storm = {&Eye(), technique_->Distances_m(), Box()};
  frame.content = technique_->Describe(scene, fields);
  frame.slices = drawn_slices_;
  frame.device_bytes = Bytes();
  const TechniqueFactory& factory = *registry_->Find(scene::NameOf(scene.rendering.technique));
  frame.content.ground = scene::DrawnGround(scene, fields);
  AddNotShown(scene, factory.Capabilities(), &frame.content);
  return frame;
}

}  // namespace thunderhead::renderers
