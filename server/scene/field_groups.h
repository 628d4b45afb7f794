// A storm's drawn fields in groups that look alike, and the noises of their detail: what a medium
// is made of, whichever code draws, traces or exports it.
#pragma once

#include <functional>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "physics/optics.h"
#include "scene/drawn_fields.h"
#include "scene/scene.h"
#include "volume/drawn_medium.h"
#include "volume/extinction.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

// Fields that scatter and swirl alike.
struct FieldGroup {
  float albedo = 1.0F;
  physics::PhaseFunction phase;  // by physics::PhaseOf
  glm::vec3 color{1.0F};
  Detail detail;  // with a wavelength if any

  bool operator==(const FieldGroup&) const = default;
};

struct GroupedFields {
  std::vector<FieldGroup> groups;
  std::vector<volume::ExtinctionTerm> terms;  // which field adds to which group's channel
  std::vector<DrawnField> fields;             // of each term
};

GroupedFields GroupedFieldsOf(const Scene& scene, const volume::HydrometeorFields& fields);

// One noise, and how much of each group it multiplies. The first of a medium displaces it, too.
struct DetailLayer {
  Detail detail;  // its share is unused
  std::vector<double> share_by_group;

  double Tile_m() const;                                      // edge of the noise's tile
  glm::dvec2 Drift_m(const volume::AirMotion& motion) const;  // of the noise
};

// Groups that differ only in their share are in one layer.
std::vector<DetailLayer> DetailLayersOf(const std::vector<FieldGroup>& groups);

// The layers in place, in a medium of such cells. `tile_of` gives a noise, which must outlive it.
using TileOf = std::function<const physics::DetailTile*(const Detail&)>;
volume::PlacedDetail PlacedDetailOf(const std::vector<DetailLayer>& layers, const TileOf& tile_of,
                                    const glm::dvec3& cell_m, const volume::AirMotion& motion);

}  // namespace thunderhead::scene
