// Descriptions of what a frame shows, as reported by its technique. This code does not use GL.
#pragma once

#include <vector>

#include "physics/hydrometeors.h"
#include "scene/capabilities.h"
#include "scene/frame_stage.h"
#include "scene/scene.h"

namespace thunderhead::renderers {

struct Content {
  std::vector<physics::Hydrometeor> fields;  // the drawn fields
  double occupied_share = 0.0;               // share of the domain's volume that is drawn
  int balls = 0;                             // number of metaballs
  // Root mean square error of the metaballs, relative to the root mean square of the extinction.
  double fit_error = 0.0;
  int ellipsoids = 0;    // number of ellipsoids of a cumulus
  scene::Ground ground;  // the ground as drawn
  std::vector<scene::NotShown> not_shown;
};

// Adds to `content` the parts of `scene` that its technique does not show. `shows` are the
// technique's capabilities. `content->fields` and `content->ground` must be set.
void AddNotShown(const scene::Scene& scene, const scene::Capabilities& shows, Content* content);

}  // namespace thunderhead::renderers
