#include "renderers/cumulus/cumulus_technique.h"

#include <vector>

#include "renderers/cumulus/cumulus_renderer.h"
#include "renderers/cumulus/surface_of_scene.h"

namespace thunderhead::renderers {
namespace {

class CumulusTechnique final : public Technique {
 public:
  explicit CumulusTechnique(Workspace& workspace)
      : workspace_(workspace), renderer_(workspace.programs) {}

  bool Empty() const override { return renderer_.Empty(); }
  bool CastsShadow() const override { return true; }
  const gl::Texture2D& Eye() const override { return renderer_.Eye(); }
  const gl::Texture2D* Distances_m() const override { return &renderer_.Distances_m(); }
  std::size_t Bytes() const override { return renderer_.Bytes(); }

  volume::WorldBox Box() const override {
    return {renderer_.Middle_m() - renderer_.HalfExtent_m(),
            renderer_.Middle_m() + renderer_.HalfExtent_m()};
  }

  absl::Status MakeContent(const scene::Scene& scene, const Fields& fields,
                           StageTimes* times) override {
    const base::Stopwatch stopwatch;
    THUNDERHEAD_ASSIGN_OR_RETURN(const DrawnSurface drawn, SurfaceOf(scene, *fields));
    renderer_.SetSurface(drawn.surface);
    fields_ = drawn.fields;
    times->push_back({scene::FrameStage::kSurface, stopwatch.ElapsedMs()});
    return absl::OkStatus();
  }

  absl::Status CarryLight(const scene::Scene& /*scene*/, const Fields& /*fields*/,
                          const RenderSettings& settings, StageTimes* times) override {
    return Timed(workspace_.Pieces(), scene::FrameStage::kLight, times, [&]() -> absl::Status {
      THUNDERHEAD_RETURN_IF_ERROR(renderer_.CastShadow(settings));
      workspace_.ground.ClearShadow();
      if (settings.illumination.towards_sun.z <= 0.0) return absl::OkStatus();
      THUNDERHEAD_ASSIGN_OR_RETURN(gl::Texture2D shadow, renderer_.GroundShadow());
      workspace_.ground.TakeShadow(std::move(shadow), renderer_.ShadowFrame(),
                                   renderer_.Middle_m());
      return absl::OkStatus();
    });
  }

  absl::Status DrawView(const scene::Scene& scene, const RenderSettings& settings,
                        StageTimes* times) override {
    return Timed(workspace_.Pieces(), scene::FrameStage::kView, times, [&] {
      return renderer_.DrawView(settings, workspace_.surroundings.LightMap(scene),
                                &workspace_.noises);
    });
  }

  Content Describe(const scene::Scene& scene,
                   const volume::HydrometeorFields& fields) const override {
    Content content;
    content.fields = fields_;
    content.ellipsoids = renderer_.BubbleCount();
    content.not_shown = NotShownByCumulus(scene, fields);
    return content;
  }

 private:
  Workspace& workspace_;
  CumulusRenderer renderer_;
  std::vector<physics::Hydrometeor> fields_;  // the storm's fields from which the surface was made
};

class CumulusFactory final : public TechniqueFactory {
 public:
  std::string_view Name() const override { return scene::Cumulus::kName; }
  scene::Capabilities Capabilities() const override { return scene::Cumulus::kCapabilities; }
  std::unique_ptr<Technique> Make(Workspace& workspace) const override {
    return std::make_unique<CumulusTechnique>(workspace);
  }
};

}  // namespace

std::shared_ptr<const TechniqueFactory> MakeCumulusFactory() {
  return std::make_shared<CumulusFactory>();
}

}  // namespace thunderhead::renderers
