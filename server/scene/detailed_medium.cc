#include "scene/detailed_medium.h"

#include <algorithm>
#include <cstddef>

#include "base/half_float.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "glm/vector_relational.hpp"
#include "scene/field_groups.h"
#include "volume/detail_control.h"
#include "volume/water_paths.h"

namespace thunderhead::scene {
namespace {

// Returns the fields in new groups, one group for each field.
GroupedFields Parted(const GroupedFields& grouped) {
  GroupedFields parted = grouped;
  parted.groups.clear();
  for (volume::ExtinctionTerm& term : parted.terms) {
    parted.groups.push_back(grouped.groups[static_cast<std::size_t>(term.channel)]);
    term.channel = static_cast<int>(parted.groups.size()) - 1;
  }
  return parted;
}

}  // namespace

std::shared_ptr<const DetailedMedium> DetailedMedium::Of(const Scene& scene,
                                                         const volume::HydrometeorFields& fields,
                                                         bool detail) {
  Scene shown = scene;
  shown.rendering.technique = LightVolume{.medium = {.look = {.detail = detail}}};
  const GroupedFields grouped = GroupedFieldsOf(shown, fields);
  const GroupedFields parted = Parted(grouped);
  THUNDERHEAD_CHECK(parted.groups.size() <= volume::kMaxChannels, "too many fields");
  const std::shared_ptr<DetailedMedium> detailed(new DetailedMedium);
  volume::ExtinctionVolume& volume = detailed->volume_;
  volume = volume::ComputeExtinction(fields, parted.terms, static_cast<int>(parted.groups.size()));
  if (volume.Empty()) return detailed;
  const auto tile_of = [&](const Detail& noise) -> const physics::DetailTile* {
    detailed->tiles_.push_back(std::make_unique<const physics::DetailTile>(
        physics::MakeDetailTile(noise.octaves, noise.seed)));
    return detailed->tiles_.back().get();
  };
  const std::vector<DetailLayer> layers = DetailLayersOf(parted.groups);
  const volume::PlacedDetail placed =
      PlacedDetailOf(layers, tile_of, volume.grid.spacing_m, fields.motion);
  if (!layers.empty()) {
    detailed->control_ = volume::DetailControlOf(fields, parted.terms, volume);
    // The factors that keep the water paths of columns are computed for each group, because detail
    // changes the fields of a group together.
    volume::ExtinctionVolume by_group =
        volume::ComputeExtinction(fields, grouped.terms, static_cast<int>(grouped.groups.size()));
    volume::PlacedDetail of_groups = placed;
    const std::vector<DetailLayer> group_layers = DetailLayersOf(grouped.groups);
    for (std::size_t i = 0; i < group_layers.size(); ++i) {
      const std::vector<double>& shares = group_layers[i].share_by_group;
      of_groups.layers[i].shares.assign(shares.begin(), shares.end());
    }
    const std::vector<float> factors =
        volume::KeepWaterPaths(of_groups, &detailed->control_, &by_group).OfVolume();
    const auto from_channels = static_cast<std::size_t>(by_group.Channels());
    const auto channels = static_cast<std::size_t>(volume.Channels());
    std::vector<float> by_field(factors.size() / from_channels * channels, 1.0F);
    for (std::size_t i = 0; i < grouped.terms.size(); ++i) {
      const auto group = static_cast<std::size_t>(grouped.terms[i].channel);
      for (std::size_t column = 0; column * channels < by_field.size(); ++column) {
        by_field[column * channels + i] = factors[column * from_channels + group];
      }
    }
    volume::ScaleColumns(by_field, &volume);
  }
  detailed->medium_.emplace(detailed->control_, placed, volume);
  return detailed;
}

volume::DrawnMedium::Channels DetailedMedium::At_per_m(const glm::dvec3& place_m) const {
  const bool inside = !volume_.Empty() && glm::all(glm::greaterThan(place_m, volume_.low_m)) &&
                      glm::all(glm::lessThan(place_m, volume_.high_m));
  if (!inside) return {};
  volume::DrawnMedium::Channels values =
      medium_->At(glm::vec3((place_m - volume_.grid.low_corner_m) / volume_.grid.spacing_m));
  // The billows can reduce the value to 0, and rounding can then make it negative.
  for (float& value : values) value = std::max(value, 0.0F) * volume_.extinction_per_m;
  return values;
}

volume::DrawnMedium::Channels DetailedMedium::Largest_per_m() const {
  volume::DrawnMedium::Channels largest{};
  std::size_t first = 0;
  for (const volume::ExtinctionPlane& plane : volume_.planes) {
    const auto channels = static_cast<std::size_t>(plane.channels);
    for (std::size_t i = 0; i < plane.texels.size(); ++i) {
      float& of_channel = largest[first + i % channels];
      of_channel = std::max(of_channel, base::FloatFromHalf(plane.texels[i]));
    }
    first += channels;
  }
  for (float& value : largest) value *= kMaxFactor * volume_.extinction_per_m;
  return largest;
}

}  // namespace thunderhead::scene
