#include "renderers/metaball/metaball_technique.h"

#include <utility>
#include <vector>

#include "renderers/metaball/ball_fit.h"
#include "renderers/metaball/metaball_renderer.h"

namespace thunderhead::renderers {
namespace {

class BallPreparation final : public Preparation {
 public:
  explicit BallPreparation(std::shared_ptr<BallFits> fits) : fits_(std::move(fits)) {}

  bool IsNeeded(const scene::Scene& scene) const override {
    return std::holds_alternative<scene::Metaballs>(scene.rendering.technique);
  }

  bool IsDone(const scene::Scene& scene, const Fields& fields) override {
    return !IsNeeded(scene) || fits_->Has(scene, fields);
  }

  absl::Status Prepare(const scene::Scene& scene, const Fields& fields) override {
    if (IsDone(scene, fields)) return absl::OkStatus();
    return fits_->Get(scene, fields).status();
  }

 private:
  std::shared_ptr<BallFits> fits_;
};

// Returns the detail of the drawn field whose detail has the largest share.
scene::Detail RoughestOf(const std::vector<scene::DrawnField>& drawn) {
  scene::Detail roughest;
  for (const scene::DrawnField& field : drawn) {
    if (field.asked_detail.share > roughest.share) roughest = field.asked_detail;
  }
  return roughest;
}

class MetaballTechnique final : public Technique {
 public:
  MetaballTechnique(Workspace& workspace, std::shared_ptr<BallFits> fits)
      : workspace_(workspace), fits_(std::move(fits)), renderer_(workspace.programs) {}

  bool DrawsMedium() const override { return true; }
  bool Empty() const override { return workspace_.medium.Empty(); }
  const gl::Texture2D& Eye() const override { return renderer_.Eye(); }
  const gl::Texture2D* Distances_m() const override { return &renderer_.Distances_m(); }
  std::size_t Bytes() const override { return renderer_.Bytes(); }

  volume::WorldBox Box() const override {
    if (renderer_.Box().Empty()) return BoxOf(workspace_.medium);
    return {renderer_.Box().low_m, renderer_.Box().high_m};
  }

  absl::Status CarryLight(const scene::Scene& scene, const Fields& fields,
                          const RenderSettings& settings, StageTimes* times) override {
    const bool kept = fits_->Has(scene, fields);
    const base::Stopwatch stopwatch;
    THUNDERHEAD_ASSIGN_OR_RETURN(balls_, fits_->Get(scene, fields));
    if (!kept) times->push_back({scene::FrameStage::kFit, stopwatch.ElapsedMs()});
    return Timed(workspace_.Pieces(), scene::FrameStage::kLight, times, [&] {
      return renderer_.CarryLight(*balls_, workspace_.medium.Content(), settings);
    });
  }

  absl::Status DrawView(const scene::Scene& /*scene*/, const RenderSettings& settings,
                        StageTimes* times) override {
    return Timed(workspace_.Pieces(), scene::FrameStage::kView, times, [&] {
      return renderer_.DrawView(settings, RoughestOf(workspace_.medium.Content().fields),
                                &workspace_.noises);
    });
  }

  Content Describe(const scene::Scene& scene,
                   const volume::HydrometeorFields& fields) const override {
    Content content = DescribeMedium(workspace_.medium, fields, false);
    if (!Empty()) {
      content.balls = static_cast<int>(balls_->balls.size());
      content.fit_error = balls_->relative_error;
    }
    using Code = scene::NotShown::Code;
    content.not_shown.push_back(
        {Code::kFineStructure,
         "structure finer than the metaballs, except noise on their surfaces"});
    if (scene::IsPaper(scene::MediumSettingsOf(scene.rendering.technique)->transport)) {
      content.not_shown.push_back(
          {Code::kFieldOptics, "the fields' albedo, phase functions and false colours"});
    }
    return content;
  }

 private:
  Workspace& workspace_;
  std::shared_ptr<BallFits> fits_;
  std::shared_ptr<const BallCloud> balls_;
  MetaballRenderer renderer_;
};

class MetaballFactory final : public TechniqueFactory {
 public:
  std::string_view Name() const override { return scene::Metaballs::kName; }
  scene::Capabilities Capabilities() const override { return scene::Metaballs::kCapabilities; }
  std::unique_ptr<Technique> Make(Workspace& workspace) const override {
    return std::make_unique<MetaballTechnique>(workspace, fits_);
  }
  std::shared_ptr<Preparation> PreparationOfScenes() const override {
    return std::make_shared<BallPreparation>(fits_);
  }

 private:
  std::shared_ptr<BallFits> fits_ = std::make_shared<BallFits>();
};

}  // namespace

std::shared_ptr<const TechniqueFactory> MakeMetaballFactory() {
  return std::make_shared<MetaballFactory>();
}

}  // namespace thunderhead::renderers
