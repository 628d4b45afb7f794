#include "renderers/half_angle/half_angle_technique.h"

#include "base/status.h"
#include "renderers/half_angle/half_angle_renderer.h"

namespace thunderhead::renderers {
namespace {

// Half-angle slicing as a technique. It propagates the light in DrawView, because light and view
// advance together.
class HalfAngleTechnique final : public Technique {
 public:
  explicit HalfAngleTechnique(Workspace& workspace)
      : workspace_(workspace), renderer_(workspace.programs) {}

  bool DrawsMedium() const override { return true; }
  bool Empty() const override { return workspace_.medium.Empty(); }
  volume::WorldBox Box() const override { return BoxOf(workspace_.medium); }
  bool KeepsToCover() const override { return true; }
  const gl::Texture2D& Eye() const override { return renderer_.Eye(); }
  const gl::Texture2D* Distances_m() const override { return &renderer_.Distances_m(); }
  std::size_t Bytes() const override { return renderer_.Bytes(); }

  absl::Status CarryLight(const scene::Scene& /*scene*/, const Fields& /*fields*/,
                          const RenderSettings& /*settings*/, StageTimes* /*times*/) override {
    light_changed_ = true;
    return absl::OkStatus();
  }

  absl::Status DrawView(const scene::Scene& /*scene*/, const RenderSettings& settings,
                        StageTimes* times) override {
    THUNDERHEAD_RETURN_IF_ERROR(Timed(workspace_.Pieces(), scene::FrameStage::kSlices, times, [&] {
      return renderer_.Render(workspace_.medium, settings, light_changed_);
    }));
    // If Render was cancelled, the flag stays set, because the light may be incomplete.
    light_changed_ = false;
    return absl::OkStatus();
  }

  Content Describe(const scene::Scene& /*scene*/,
                   const volume::HydrometeorFields& fields) const override {
    return DescribeMedium(workspace_.medium, fields, true);
  }

 private:
  Workspace& workspace_;
  HalfAngleRenderer renderer_;
  bool light_changed_ = true;
};

class HalfAngleFactory final : public TechniqueFactory {
 public:
  std::string_view Name() const override { return scene::HalfAngle::kName; }
  scene::Capabilities Capabilities() const override { return scene::HalfAngle::kCapabilities; }
  std::unique_ptr<Technique> Make(Workspace& workspace) const override {
    return std::make_unique<HalfAngleTechnique>(workspace);
  }
};

}  // namespace

std::shared_ptr<const TechniqueFactory> MakeHalfAngleFactory() {
  return std::make_shared<HalfAngleFactory>();
}

}  // namespace thunderhead::renderers
