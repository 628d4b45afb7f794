#include "volume/extinction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "base/half_float.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"

namespace thunderhead::volume {
namespace {

// Returns the terms that add any extinction.
std::vector<ExtinctionTerm> EffectiveTerms(const HydrometeorFields& fields,
                                           const std::vector<ExtinctionTerm>& terms) {
  std::vector<ExtinctionTerm> effective;
  for (const ExtinctionTerm& term : terms) {
    const HydrometeorField& field = fields.fields[static_cast<std::size_t>(term.field)];
    if (!field.concentration_kg_per_m3.empty() && term.mass_extinction_m2_per_kg > 0.0F) {
      effective.push_back(term);
    }
  }
  return effective;
}

// Writes the total extinction of the cells (low_x.., y, z) to `row`.
void SumRow(const HydrometeorFields& fields, const std::vector<ExtinctionTerm>& terms, int low_x,
            int y, int z, std::vector<float>* row) {
  std::fill(row->begin(), row->end(), 0.0F);
  const std::size_t offset = fields.grid.Offset(low_x, y, z);
  for (const ExtinctionTerm& term : terms) {
    AddExtinction(fields.fields[static_cast<std::size_t>(term.field)],
                  {term.mass_extinction_m2_per_kg, term.by_cell}, offset, row->size(), row->data());
  }
}

struct Occupied {
  CellBox cells;
  float maximum_per_m = 0.0F;
  float negligible_per_m = 0.0F;
};

void Include(int x, int y, int z, CellBox* box) {
  box->low = glm::min(box->low, glm::ivec3(x, y, z));
  box->high = glm::max(box->high, glm::ivec3(x + 1, y + 1, z + 1));
}

// Returns the box around all cells whose extinction is above `negligible_per_m`, and the largest
// extinction in the box.
Occupied FindAbove(const HydrometeorFields& fields, const std::vector<ExtinctionTerm>& terms,
                   float negligible_per_m) {
  const CellBox& search = fields.condensate;
  Occupied found{{fields.grid.cells, glm::ivec3(0)}, 0.0F, negligible_per_m};
  const auto above = [&](float value) { return value > negligible_per_m; };
  std::vector<float> row(static_cast<std::size_t>(search.high.x - search.low.x));
  for (int z = search.low.z; z < search.high.z; ++z) {
    for (int y = search.low.y; y < search.high.y; ++y) {
      SumRow(fields, terms, search.low.x, y, z, &row);
      const auto first = std::find_if(row.begin(), row.end(), above);
      if (first == row.end()) continue;
      const auto last = std::find_if(row.rbegin(), row.rend(), above);
      Include(search.low.x + static_cast<int>(first - row.begin()), y, z, &found.cells);
      Include(search.low.x + static_cast<int>(row.rend() - last) - 1, y, z, &found.cells);
      found.maximum_per_m =
          std::max(found.maximum_per_m, *std::max_element(row.begin(), row.end()));
    }
  }
  return found;
}

Occupied FindOccupied(const HydrometeorFields& fields, const std::vector<ExtinctionTerm>& terms) {
  // The scan begins with the threshold for thick media, so that only a medium that is thin
  // everywhere must be scanned again.
  Occupied found =
      FindAbove(fields, terms,
                NegligibleExtinction_per_m(fields.grid, std::numeric_limits<float>::infinity()));
  if (found.cells.Empty()) {
    found.maximum_per_m = FindAbove(fields, terms, 0.0F).maximum_per_m;
  }
  const float negligible_per_m = NegligibleExtinction_per_m(fields.grid, found.maximum_per_m);
  if (negligible_per_m == found.negligible_per_m) return found;
  return FindAbove(fields, terms, negligible_per_m);
}

// Grows the box by one cell inside the domain and places it in the world.
void PlaceBox(const RegularGrid& domain, const CellBox& occupied, ExtinctionVolume* volume) {
  const glm::ivec3 low = glm::max(occupied.low - 1, glm::ivec3(0));
  const glm::ivec3 high = glm::min(occupied.high + 1, domain.cells);
  volume->grid.cells = high - low;
  volume->grid.spacing_m = domain.spacing_m;
  volume->grid.low_corner_m = domain.low_corner_m + glm::dvec3(low) * domain.spacing_m;
  // A border cell is empty, so extinction falls to zero at its centre.
  const glm::dvec3 low_border(glm::notEqual(low, occupied.low));
  const glm::dvec3 high_border(glm::notEqual(high, occupied.high));
  volume->low_m = volume->grid.low_corner_m + 0.5 * low_border * domain.spacing_m;
  volume->high_m = volume->grid.HighCorner_m() - 0.5 * high_border * domain.spacing_m;
}

int RoundUpToFormat(int channels) { return channels == 3 ? 4 : channels; }

void FillPlane(const HydrometeorFields& fields, const std::vector<ExtinctionTerm>& terms,
               const glm::ivec3& low, int first_channel, const ExtinctionVolume& volume,
               ExtinctionPlane* plane) {
  const glm::ivec3 cells = volume.grid.cells;
  const auto width = static_cast<std::size_t>(cells.x);
  const auto stride = static_cast<std::size_t>(plane->channels);
  const float texel_per_extinction = 1.0F / volume.extinction_per_m;
  plane->texels.assign(volume.grid.CellCount() * stride, 0);
  std::vector<float> row(width * stride);
  for (int z = 0; z < cells.z; ++z) {
    for (int y = 0; y < cells.y; ++y) {
      std::fill(row.begin(), row.end(), 0.0F);
      const std::size_t source = fields.grid.Offset(low.x, low.y + y, low.z + z);
      for (const ExtinctionTerm& term : terms) {
        const int channel = term.channel - first_channel;
        if (channel < 0 || channel >= plane->channels) continue;
        const float weight = term.mass_extinction_m2_per_kg * texel_per_extinction;
        AddExtinction(fields.fields[static_cast<std::size_t>(term.field)], {weight, term.by_cell},
                      source, width, row.data() + channel, stride);
      }
      std::uint16_t* texels = plane->texels.data() + volume.grid.Offset(0, y, z) * stride;
      for (std::size_t i = 0; i < row.size(); ++i) texels[i] = base::HalfFromFloat(row[i]);
    }
  }
}

}  // namespace

int ExtinctionVolume::Channels() const {
  return std::accumulate(
      planes.begin(), planes.end(), 0,
      [](int channels, const ExtinctionPlane& plane) { return channels + plane.channels; });
}

float NegligibleExtinction_per_m(const RegularGrid& grid, float maximum_per_m) {
  const double diagonal_m = glm::length(glm::dvec3(grid.cells) * grid.spacing_m);
  const double least_per_m = kFaintestOpticalDepth / diagonal_m;
  if (maximum_per_m <= least_per_m) return static_cast<float>(least_per_m);
  return static_cast<float>(kNegligibleOpticalDepth *
                            std::min<double>(1.0 / diagonal_m, maximum_per_m));
}

ExtinctionVolume ComputeExtinction(const HydrometeorFields& fields,
                                   const std::vector<ExtinctionTerm>& terms, int channels) {
  THUNDERHEAD_CHECK(channels >= 0 && channels <= kMaxChannels, std::to_string(channels));
  ExtinctionVolume volume;
  const std::vector<ExtinctionTerm> effective = EffectiveTerms(fields, terms);
  if (effective.empty() || fields.condensate.Empty()) return volume;
  const Occupied occupied = FindOccupied(fields, effective);
  if (occupied.cells.Empty()) return volume;
  volume.negligible_per_m = occupied.negligible_per_m;
  PlaceBox(fields.grid, occupied.cells, &volume);
  volume.maximum_per_m = occupied.maximum_per_m;
  // With this unit, the largest texel value lies between 2^14 and 2^15. The smallest normal half
  // float is then about 3e-9 times the largest value.
  volume.extinction_per_m = std::ldexp(1.0F, std::ilogb(volume.maximum_per_m) - 14);
  const glm::ivec3 low = glm::max(occupied.cells.low - 1, glm::ivec3(0));
  for (int first = 0; first < channels; first += 4) {
    ExtinctionPlane plane;
    plane.channels = RoundUpToFormat(std::min(channels - first, 4));
    FillPlane(fields, effective, low, first, volume, &plane);
    volume.planes.push_back(std::move(plane));
  }
  return volume;
}

}  // namespace thunderhead::volume
