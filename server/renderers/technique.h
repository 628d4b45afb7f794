// A technique for drawing a scene. This file has the interface that the scene renderer calls stage
// by stage, and the factory of each technique in the registry (renderers/technique_registry.h). A
// technique's settings are in scene/techniques/. docs/extending.md explains how to add one.
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

// Objects that the techniques of one scene renderer share. The techniques must not outlive the
// workspace.
struct Workspace {
  explicit Workspace(std::shared_ptr<gl::ProgramCache> cache)
      : programs(std::move(cache)), ground(programs), surroundings(programs) {}

  gl::Pieces& Pieces() const { return programs->Pieces(); }

  std::shared_ptr<gl::ProgramCache> programs;
  DetailNoises noises;
  ResidentMedium medium;  // the scene's medium, for techniques that draw one
  Ground ground;
  GroundCover ground_cover;
  SkyAndGround surroundings;
};

// A technique. The scene renderer calls its stages in order, beginning with the first stage whose
// inputs changed. It calls the stages after MakeContent only if Empty returns false.
class Technique {
 public:
  using Fields = std::shared_ptr<const volume::HydrometeorFields>;

  virtual ~Technique() = default;

  // Returns true if the technique draws the workspace's medium. The scene renderer then creates and
  // keeps the medium.
  virtual bool DrawsMedium() const { return false; }
  // Creates everything that the technique draws except the workspace's medium. Returns
  // INVALID_ARGUMENT for unsupported settings.
  virtual absl::Status MakeContent(const scene::Scene& scene, const Fields& fields,
                                   StageTimes* times);
  // Returns true if there is nothing to draw.
  virtual bool Empty() const = 0;
  // Returns the bounding box of what is drawn.
  virtual volume::WorldBox Box() const = 0;

  // Computes the light that arrives at the content. If CastsShadow returns true, the function must
  // set or clear the ground's shadow (Ground::TakeShadow, ShareShadow or ClearShadow). Otherwise
  // the shadow is computed from the workspace's medium.
  virtual absl::Status CarryLight(const scene::Scene& scene, const Fields& fields,
                                  const RenderSettings& settings, StageTimes* times) = 0;
  virtual bool CastsShadow() const { return false; }

  // Draws the storm as the eye sees it, before sky and ground are added. The result's rgb is
  // radiance, a is the transmittance to the background.
  virtual absl::Status DrawView(const scene::Scene& scene, const RenderSettings& settings,
                                StageTimes* times) = 0;
  // Returns true if the technique draws only the workspace's medium, so that the eye buffer is
  // empty outside the medium's occupied bricks (blocks of cells that are not empty).
  virtual bool KeepsToCover() const { return false; }
  // Returns true if DrawView supports RenderSettings::chosen.
  virtual bool DrawsChosen() const { return false; }
  // Returns the result of the last DrawView.
  virtual const gl::Texture2D& Eye() const = 0;
  // Returns the mean distance of Eye's content from the eye, weighted by each part's contribution
  // to the ray, times the opacity. The texture has one channel and Eye's size. If the result is
  // null, the content counts as lying in the middle of each ray's path through Box.
  virtual const gl::Texture2D* Distances_m() const { return nullptr; }

  virtual Content Describe(const scene::Scene& scene,
                           const volume::HydrometeorFields& fields) const = 0;
  // Returns the bytes on the device, without those of the workspace.
  virtual std::size_t Bytes() const = 0;
};

// Returns the content of a technique that draws the workspace's medium. `leaps` is true if the
// technique skips empty bricks. Otherwise the medium's whole box counts as drawn.
Content DescribeMedium(const ResidentMedium& medium, const volume::HydrometeorFields& fields,
                       bool leaps);
// Returns the box around the workspace's medium.
volume::WorldBox BoxOf(const ResidentMedium& medium);

// Runs `work` and appends its wall time, including the time of its GL commands. The time for which
// its pieces (gl/pieces.h) waited for other work is not counted. Returns the error of `work`, or
// the error with which Pieces::Between ends the drawing.
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
  // Returns null for a technique without a renderer, which is path-traced (Capabilities::images is
  // false).
  virtual std::unique_ptr<Technique> Make(Workspace& workspace) const = 0;
  // Returns null if no scene of the technique needs preparation.
  virtual std::shared_ptr<Preparation> PreparationOfScenes() const { return nullptr; }
};

}  // namespace thunderhead::renderers
