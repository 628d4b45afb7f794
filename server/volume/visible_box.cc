#include "volume/visible_box.h"

#include <array>
#include <numeric>
#include <utility>
#include <vector>

namespace thunderhead::volume {
namespace {

constexpr double kShareLeftOut = 1e-3;

// Extinction summed over planes across each axis.
using Profiles = std::array<std::vector<double>, 3>;

void AddField(const HydrometeorFields& fields, const HydrometeorField& field,
              physics::SizeSource sizes, Profiles* profiles) {
  const physics::ParticleOptics& optics = physics::DefaultOptics(field.hydrometeor);
  const MassExtinction mass_extinction = MassExtinctionOf(field, optics, sizes);
  const CellBox& box = fields.condensate;
  std::vector<float> row(static_cast<std::size_t>(box.high.x - box.low.x));
  for (int z = box.low.z; z < box.high.z; ++z) {
    for (int y = box.low.y; y < box.high.y; ++y) {
      row.assign(row.size(), 0.0F);
      AddExtinction(field, mass_extinction, fields.grid.Offset(box.low.x, y, z), row.size(),
                    row.data());
      double sum = 0.0;
      for (int x = box.low.x; x < box.high.x; ++x) {
        const double extinction = row[static_cast<std::size_t>(x - box.low.x)];
        (*profiles)[0][static_cast<std::size_t>(x)] += extinction;
        sum += extinction;
      }
      (*profiles)[1][static_cast<std::size_t>(y)] += sum;
      (*profiles)[2][static_cast<std::size_t>(z)] += sum;
    }
  }
}

// Returns the first plane and the end of the range of planes that leaves out kShareLeftOut of the
// profile at either end.
std::pair<int, int> Keep(const std::vector<double>& profile) {
  const double max_left_out = kShareLeftOut * std::accumulate(profile.begin(), profile.end(), 0.0);
  int low = 0;
  for (double sum = profile.front(); sum < max_left_out;) sum += profile[++low];
  int high = static_cast<int>(profile.size());
  for (double sum = profile.back(); sum < max_left_out;) sum += profile[--high - 1];
  return {low, high};
}

}  // namespace

WorldBox VisibleBox(const HydrometeorFields& fields, physics::SizeSource sizes) {
  const RegularGrid& grid = fields.grid;
  Profiles profiles;
  for (int axis = 0; axis < 3; ++axis) {
    profiles[static_cast<std::size_t>(axis)].assign(static_cast<std::size_t>(grid.cells[axis]),
                                                    0.0);
  }
  for (const HydrometeorField& field : fields.fields) {
    if (!field.concentration_kg_per_m3.empty()) AddField(fields, field, sizes, &profiles);
  }
  WorldBox box{grid.low_corner_m, grid.HighCorner_m()};
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = Keep(profiles[static_cast<std::size_t>(axis)]);
    box.low_m[axis] = grid.low_corner_m[axis] + low * grid.spacing_m[axis];
    box.high_m[axis] = grid.low_corner_m[axis] + high * grid.spacing_m[axis];
  }
  return box;
}

}  // namespace thunderhead::volume
