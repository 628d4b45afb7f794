#include "scene/field_groups.h"

#include <algorithm>

#include "physics/detail_tile.h"

namespace thunderhead::scene {

GroupedFields GroupedFieldsOf(const Scene& scene, const volume::HydrometeorFields& fields) {
  GroupedFields grouped;
  for (const DrawnField& field : DrawnFieldsOf(scene, fields)) {
    const FieldGroup group{field.albedo, field.phase, field.color, field.detail};
    auto found = std::find(grouped.groups.begin(), grouped.groups.end(), group);
    if (found == grouped.groups.end()) found = grouped.groups.insert(found, group);
    grouped.terms.push_back({static_cast<int>(field.index), field.mass_extinction.m2_per_kg,
                             static_cast<int>(found - grouped.groups.begin()),
                             field.mass_extinction.by_cell});
    grouped.fields.push_back(field);
  }
  return grouped;
}

double DetailLayer::Tile_m() const {
  return static_cast<double>(detail.wavelength_m) * physics::DetailTile::kWaves;
}

glm::dvec2 DetailLayer::Drift_m(const volume::AirMotion& motion) const {
  return physics::DetailDrift_m(motion.steering_m_per_s, motion.time_s, Tile_m());
}

std::vector<DetailLayer> DetailLayersOf(const std::vector<FieldGroup>& groups) {
  std::vector<DetailLayer> layers;
  for (std::size_t group = 0; group < groups.size(); ++group) {
    const Detail& detail = groups[group].detail;
    if (detail.share <= 0.0F) continue;
    const auto same = [&](const DetailLayer& layer) {
      Detail shared = layer.detail;
      shared.share = detail.share;
      return shared == detail;
    };
    auto found = std::find_if(layers.begin(), layers.end(), same);
    if (found == layers.end()) {
      found = layers.insert(found, {detail, std::vector<double>(groups.size(), 0.0)});
    }
    found->share_by_group[group] = detail.share;
  }
  return layers;
}

volume::PlacedDetail PlacedDetailOf(const std::vector<DetailLayer>& layers, const TileOf& tile_of,
                                    const glm::dvec3& cell_m, const volume::AirMotion& motion) {
  volume::PlacedDetail placed;
  for (const DetailLayer& layer : layers) {
    placed.layers.push_back(
        {tile_of(layer.detail), layer.Tile_m(),
         std::vector<float>(layer.share_by_group.begin(), layer.share_by_group.end()),
         layer.Drift_m(motion)});
  }
  if (!layers.empty()) placed.warp_m = physics::DetailWarp_m(cell_m, layers[0].detail.wavelength_m);
  placed.fibres = physics::FibresAlong(motion.shear_m_per_s);
  return placed;
}

}  // namespace thunderhead::scene
