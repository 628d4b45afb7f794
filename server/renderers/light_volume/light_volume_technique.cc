#include "renderers/light_volume/light_volume_technique.h"

#include "renderers/ground_light.h"
#include "renderers/light_frame.h"
#include "renderers/light_volume/light_volume_renderer.h"

namespace thunderhead::renderers {
namespace {

class LightVolumeTechnique final : public Technique {
 public:
  explicit LightVolumeTechnique(Workspace& workspace)
      : workspace_(workspace), renderer_(workspace.programs), ground_light_(workspace.programs) {}

  bool DrawsMedium() const override { return true; }
  bool Empty() const override { return workspace_.medium.Empty(); }
  volume::WorldBox Box() const override { return BoxOf(workspace_.medium); }
  bool CastsShadow() const override { return true; }
  bool KeepsToCover() const override { return true; }
  bool DrawsChosen() const override { return true; }
  const gl::Texture2D& Eye() const override { return renderer_.Eye(); }
  const gl::Texture2D* Distances_m() const override { return &renderer_.Distances_m(); }
  std::size_t Bytes() const override { return renderer_.Bytes() + ground_light_.Bytes(); }

  absl::Status CarryLight(const scene::Scene& scene, const Fields& /*fields*/,
                          const RenderSettings& settings, StageTimes* times) override {
    return Timed(workspace_.Pieces(), scene::FrameStage::kLight, times, [&]() -> absl::Status {
      bool shares_shadow = false;
      const auto find_ground = [&]() -> absl::StatusOr<LitGround> {
        ShareShadow(settings.illumination.towards_sun);
        shares_shadow = true;
        THUNDERHEAD_RETURN_IF_ERROR(
            workspace_.surroundings.HideSky(scene, workspace_.ground, workspace_.medium));
        return ground_light_.Find(workspace_.ground, workspace_.surroundings, Box(),
                                  settings.illumination);
      };
      THUNDERHEAD_RETURN_IF_ERROR(renderer_.CarryLight(workspace_.medium, settings, find_ground));
      if (!shares_shadow) ShareShadow(settings.illumination.towards_sun);
      return absl::OkStatus();
    });
  }

  absl::Status DrawView(const scene::Scene& /*scene*/, const RenderSettings& settings,
                        StageTimes* times) override {
    return Timed(workspace_.Pieces(), scene::FrameStage::kView, times,
                 [&] { return renderer_.DrawView(workspace_.medium, settings); });
  }

  Content Describe(const scene::Scene& scene,
                   const volume::HydrometeorFields& fields) const override {
    Content content = DescribeMedium(workspace_.medium, fields, true);
    const auto& asked = std::get<scene::LightVolume>(scene.rendering.technique);
    if (asked.traced_light != asked.TracedLightShown()) {
      content.not_shown.push_back(
          {scene::NotShown::Code::kTracedLight,
           "the path-traced correction of the light (choose diffusion transport for it)"});
    }
    return content;
  }

 private:
  // LightVolumeRenderer::CarryLight has already computed the shadow on the ground, so it is reused.
  void ShareShadow(const glm::dvec3& towards_sun) {
    const ResidentMedium& medium = workspace_.medium;
    if (towards_sun.z <= 0.0) return workspace_.ground.ClearShadow();
    workspace_.ground.ShareShadow(
        &renderer_.Shadow(), LightFrameOf({medium.HalfExtent_m()}, towards_sun), medium.Middle_m());
  }

  Workspace& workspace_;
  LightVolumeRenderer renderer_;
  GroundLight ground_light_;
};

class LightVolumeFactory final : public TechniqueFactory {
 public:
  std::string_view Name() const override { return scene::LightVolume::kName; }
  scene::Capabilities Capabilities() const override { return scene::LightVolume::kCapabilities; }
  std::unique_ptr<Technique> Make(Workspace& workspace) const override {
    return std::make_unique<LightVolumeTechnique>(workspace);
  }
};

}  // namespace

std::shared_ptr<const TechniqueFactory> MakeLightVolumeFactory() {
  return std::make_shared<LightVolumeFactory>();
}

}  // namespace thunderhead::renderers
