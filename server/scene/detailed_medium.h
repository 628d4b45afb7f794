// A storm's extinction at any place, field by field, with the turbulent detail that the light
// volume draws: the same displacement and noise, and columns that keep their water path. For code
// that has no GL.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "scene/scene.h"
#include "volume/drawn_medium.h"
#include "volume/extinction.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

class DetailedMedium {
 public:
  // Each field has the detail that `scene` gives it, whatever its technique, or none without
  // `detail`. `fields` need not outlive it.
  static std::shared_ptr<const DetailedMedium> Of(const Scene& scene,
                                                  const volume::HydrometeorFields& fields,
                                                  bool detail = true);

  // 1/m, in the order of DrawnFieldsOf. Detail is that of a picture with infinitely fine pixels.
  volume::DrawnMedium::Channels At_per_m(const glm::dvec3& place_m) const;

  // Its cells, and the box of what is not empty.
  const volume::ExtinctionVolume& Volume() const { return volume_; }

  // By field, an upper bound of extinction in 1/m.
  volume::DrawnMedium::Channels Largest_per_m() const;

  // Detail multiplies a field by at most this.
  static constexpr float kMaxFactor = 4.0F;

 private:
  DetailedMedium() = default;

  volume::ExtinctionVolume volume_;  // a channel for each field
  volume::DetailControl control_;
  std::vector<std::unique_ptr<const physics::DetailTile>> tiles_;
  std::optional<volume::DrawnMedium> medium_;
};

}  // namespace thunderhead::scene
