// A storm's drawn fields in groups with equal optics and detail, and the noises of their detail.
// The fields of a group add up to one channel of the extinction volume. Renderers, tracers and
// exporters build their medium from these groups.
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

// Optical properties and detail that the fields of a group have in common.
struct FieldGroup {
  float albedo = 1.0F;
  physics::PhaseFunction phase;  // canonical form from physics::PhaseOf
  glm::vec3 color{1.0F};
  Detail detail;  // the wavelength is above 0 if the group has detail

  bool operator==(const FieldGroup&) const = default;
};

struct GroupedFields {
  std::vector<FieldGroup> groups;
  // For each drawn field, the group to whose channel it adds.
  std::vector<volume::ExtinctionTerm> terms;
  std::vector<DrawnField> fields;  // the field of each term
};

// Groups the storm's drawn fields by equal optics and detail.
GroupedFields GroupedFieldsOf(const Scene& scene, const volume::HydrometeorFields& fields);

// One noise texture and, for each group, the share of the extinction that the noise multiplies. The
// first layer of a medium also displaces the medium.
struct DetailLayer {
  Detail detail;  // wavelength, octaves and seed of the noise; `share` is unused
  std::vector<double> share_by_group;

  double Tile_m() const;  // edge length of the noise's tile
  // Returns how far the wind has displaced the noise.
  glm::dvec2 Drift_m(const volume::AirMotion& motion) const;
};

// Returns the layers of the groups. Groups whose details differ only in `share` have a common
// layer.
std::vector<DetailLayer> DetailLayersOf(const std::vector<FieldGroup>& groups);

// Returns the layers placed in a medium with cells of size `cell_m`. `tile_of` returns the noise
// tile of a detail, which must outlive the result.
using TileOf = std::function<const physics::DetailTile*(const Detail&)>;
volume::PlacedDetail PlacedDetailOf(const std::vector<DetailLayer>& layers, const TileOf& tile_of,
                                    const glm::dvec3& cell_m, const volume::AirMotion& motion);

}  // namespace thunderhead::scene
