// One way to draw a scene: the interface that the scene renderer drives, stage by stage, and the
// factory that the registry of techniques (renderers/technique_registry.h) keeps of each. Its
// settings are in scene/techniques/. docs/extending.md walks through a new one.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "renderers/content.h"
#include "renderers/detail_noises.h"
#include "renderers/ground.h"
#include "renderers/ground_cover.h"
#include "renderers/medium.h"
#include "renderers/preparation.h"
#include "renderers/render_settings.h"
#include "renderers/sky_and_ground.h"
#include "scene/capabilities.h"
#include "scene/frame_stage.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"
#include "volume/visible_box.h"

namespace thunderhead::renderers {

using StageTimes = std::vector<scene::StageTime>;

// Parts that the techniques of one scene renderer share; they must not outlive it.
struct Workspace {
  explicit Workspace(std::shared_ptr<gl::ProgramCache> cache)
      : programs(std::move(cache)), ground(programs), surroundings(programs) {}

  gl::Pieces& Pieces() const { return programs->Pieces(); }

  std::shared_ptr<gl::ProgramCache> programs;
  DetailNoises noises;
  ResidentMedium medium;  // the scene's, for techniques that draw a medium
  Ground ground;
  GroundCover ground_cover;
  SkyAndGround surroundings;
};

// The stages are called in order, from the first that is dirty; those after MakeContent only while
// there is something to draw.
class Technique {
 public:
  using Fields = std::shared_ptr<const volume::HydrometeorFields>;

  virtual ~Technique() = default;

  // True if it draws the workspace's medium, which is made and kept for it.
  virtual bool DrawsMedium() const { return false; }
  // Makes whatever else it draws; INVALID_ARGUMENT for settings that it does not take.
  virtual absl::Status MakeContent(const scene::Scene& scene, const Fields& fields,
                                   StageTimes* times);
  // True if there is nothing to draw.
  virtual bool Empty() const = 0;
  // Around what is drawn.
  virtual volume::WorldBox Box() const = 0;

  // Lights what is drawn. The ground's shadow is the technique's to give (Ground::TakeShadow) if
  // CastsShadow, else it is that of the workspace's medium.
  virtual absl::Status CarryLight(const scene::Scene& scene, const Fields& fields,
                                  const RenderSettings& settings, StageTimes* times) = 0;
  virtual bool CastsShadow() const { return false; }

  // Draws what the eye sees before sky and ground: rgb is radiance, a the transmittance to the
  // background.
  virtual absl::Status DrawView(const scene::Scene& scene, const RenderSettings& settings,
                                StageTimes* times) = 0;
  // True if what is drawn is the workspace's medium itself: nothing away from its occupied bricks.
  virtual bool KeepsToCover() const { return false; }
  // True if DrawView draws RenderSettings::chosen.
  virtual bool DrawsChosen() const { return false; }
  // The result of the last DrawView.
  virtual const gl::Texture2D& Eye() const = 0;
  // Its mean distance from the eye, weighted by what each part of the ray shows, times its opacity:
  // one channel, of Eye's size. Null if that is not known: the middle of Box is taken.
  virtual const gl::Texture2D* Distances_m() const { return nullptr; }

  virtual Content Describe(const scene::Scene& scene,
                           const volume::HydrometeorFields& fields) const = 0;
  // On the device, without the workspace.
  virtual std::size_t Bytes() const = 0;
};

// The content of a technique that draws the workspace's medium, leaping over empty bricks or not.
Content DescribeMedium(const ResidentMedium& medium, const volume::HydrometeorFields& fields,
                       bool leaps);
// Around the workspace's medium.
volume::WorldBox BoxOf(const ResidentMedium& medium);

// Runs `work` and appends its wall time, GL included, but not the time that its pieces waited for
// their turns.
template <typename Work>
absl::Status Timed(gl::Pieces& pieces, scene::FrameStage stage, StageTimes* times,
                   const Work& work) {
  const base::Stopwatch stopwatch;
  const double waited_ms = pieces.WaitedMs();
  THUNDERHEAD_RETURN_IF_ERROR(work());
  glFinish();
  times->push_back({stage, stopwatch.ElapsedMs() - (pieces.WaitedMs() - waited_ms)});
  return pieces.Between();
}

class TechniqueFactory {
 public:
  virtual ~TechniqueFactory() = default;

  virtual std::string_view Name() const = 0;
  virtual scene::Capabilities Capabilities() const = 0;
  // Null for a technique that is not drawn but traced (Capabilities::images is false).
  virtual std::unique_ptr<Technique> Make(Workspace& workspace) const = 0;
  // Null if its scenes never wait for anything.
  virtual std::shared_ptr<Preparation> PreparationOfScenes() const { return nullptr; }
};

}  // namespace thunderhead::renderers
