// The extinction of a storm at any place, by field, including turbulent detail. The light volume
// draws the same medium on the GPU. This class applies the same displacement and noise without GL.
// Detail does not change the water path of a column, which is the water above an area of ground.
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
  // Creates the medium with the detail that `scene` gives each field, even if the scene's technique
  // shows none. With `detail` false, no field has detail. `fields` need not outlive the medium.
  static std::shared_ptr<const DetailedMedium> Of(const Scene& scene,
                                                  const volume::HydrometeorFields& fields,
                                                  bool detail = true);

  // Returns the extinction in 1/m by field, in the order of DrawnFieldsOf. The detail is that of an
  // image with infinitely fine pixels.
  volume::DrawnMedium::Channels At_per_m(const glm::dvec3& place_m) const;

  // Returns the extinction on the grid's cells, with the bounding box of the cells that are not
  // empty. It does not include the noise, but it includes the factors that compensate for the mean
  // loss of extinction by the noise.
  const volume::ExtinctionVolume& Volume() const { return volume_; }

  // Returns an upper bound of each field's extinction in 1/m.
  volume::DrawnMedium::Channels Largest_per_m() const;

  // The largest factor by which detail multiplies a field.
  static constexpr float kMaxFactor = 4.0F;

 private:
  DetailedMedium() = default;

  volume::ExtinctionVolume volume_;  // one channel for each field
  volume::DetailControl control_;
  std::vector<std::unique_ptr<const physics::DetailTile>> tiles_;
  std::optional<volume::DrawnMedium> medium_;
};

}  // namespace thunderhead::scene
