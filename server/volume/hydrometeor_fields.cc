#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

std::size_t HydrometeorFields::Bytes() const {
  std::size_t values = terrain_height_m.capacity();
  for (const HydrometeorField& field : fields) values += field.concentration_kg_per_m3.capacity();
  return values * sizeof(float);
}

}  // namespace thunderhead::volume
