// Makes a wide domain from copies of one storm. Its size is that of a regional model, about a
// thousand kilometres.
#pragma once

#include <memory>

#include "volume/hydrometeor_fields.h"

namespace thunderhead::support {

// Repeats `storm` `across` by `along` times. Keeps only every `stride`-th column, and enlarges the
// cells by the same factor. The terrain is level. The fields' values are copied, so their
// statistics stay those of the storm.
inline std::shared_ptr<const volume::HydrometeorFields> WideDomain(
    const volume::HydrometeorFields& storm, int across, int along, int stride) {
  auto wide = std::make_shared<volume::HydrometeorFields>();
  const volume::RegularGrid& grid = storm.grid;
  const glm::ivec3 tile((grid.cells.x + stride - 1) / stride, (grid.cells.y + stride - 1) / stride,
                        grid.cells.z);
  wide->grid.cells = tile * glm::ivec3(across, along, 1);
  wide->grid.spacing_m = grid.spacing_m * glm::dvec3(stride, stride, 1);
  wide->grid.low_corner_m =
      -0.5 * glm::dvec3(wide->grid.cells) * wide->grid.spacing_m * glm::dvec3(1, 1, 0);
  wide->grid.low_corner_m.z = grid.low_corner_m.z;
  wide->condensate = {{0, 0, storm.condensate.low.z},
                      {wide->grid.cells.x, wide->grid.cells.y, storm.condensate.high.z}};
  for (const volume::HydrometeorField& field : storm.fields) {
    volume::HydrometeorField& tiled = wide->fields.emplace_back(field);
    if (field.concentration_kg_per_m3.empty()) continue;
    const std::size_t count = wide->grid.CellCount();
    tiled.concentration_kg_per_m3.assign(count, 0.0F);
    const bool sized = !field.sizes.Empty();
    constexpr std::uint16_t kAnyRadius = 0x3c00;  // inverse radius (as a 16-bit float, 1.0) of
                                                  // cells without particles, where it has no effect
    tiled.sizes.first_cell = 0;
    tiled.sizes.inverse_radius.assign(sized ? count : 0, kAnyRadius);
    std::size_t to = 0;
    for (int z = 0; z < wide->grid.cells.z; ++z) {
      for (int y = 0; y < wide->grid.cells.y; ++y) {
        for (int x = 0; x < wide->grid.cells.x; ++x, ++to) {
          const std::size_t from = grid.Offset(x % tile.x * stride, y % tile.y * stride, z);
          tiled.concentration_kg_per_m3[to] = field.concentration_kg_per_m3[from];
          if (sized && from >= field.sizes.first_cell && from < field.sizes.EndCell()) {
            tiled.sizes.inverse_radius[to] =
                field.sizes.inverse_radius[from - field.sizes.first_cell];
          }
        }
      }
    }
  }
  return wide;
}

}  // namespace thunderhead::support
