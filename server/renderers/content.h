// A frame's content as a technique reports it. Knows no GL.
#pragma once

#include <vector>

#include "physics/hydrometeors.h"
#include "scene/capabilities.h"
#include "scene/frame_stage.h"
#include "scene/scene.h"

namespace thunderhead::renderers {

struct Content {
  std::vector<physics::Hydrometeor> fields;  // drawn
  double occupied_share = 0.0;               // of the domain's volume
  int balls = 0;                             // metaballs
  double fit_error = 0.0;                    // of those, root mean square over the extinction's own
  int ellipsoids = 0;                        // of a cumulus
  scene::Ground ground;                      // as drawn
  std::vector<scene::NotShown> not_shown;
};

// Adds the parts of `scene` that its technique, which shows `shows`, leaves out. `content` has its
// fields and ground.
void AddNotShown(const scene::Scene& scene, const scene::Capabilities& shows, Content* content);

}  // namespace thunderhead::renderers
