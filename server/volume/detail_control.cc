#include "volume/detail_control.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "glm/common.hpp"

namespace thunderhead::volume {
namespace {

using Values = std::vector<float>;

constexpr float kHalfOpaqueDepth = 4.0F;  // optical depth at which a cell is half opaque
constexpr float kFullShare = 0.7F;        // share of the neighbours' largest opacity from which a
                                          // cell counts as inside
constexpr float kGradientAmplitude = 0.8F;
constexpr int kProfileSmoothings = 2;  // together they move surfaces by at most a cell
// Ranges of upward velocity in m/s. Over the first range, the share of cloud water that has billows
// grows from 0 to 1, because cloud water condenses in rising air. Over the second range, the share
// of ice that has billows grows in the same way. Ice in fast updraughts still looks like the liquid
// tower from which it rises.
constexpr std::array<float, 2> kCondensing_m_per_s = {0.0F, 1.0F};
constexpr std::array<float, 2> kIceBillows_m_per_s = {1.0F, 5.0F};
// The range over which the share of ice that has billows grows from 0 to 1 in turbulent air. It is
// a range of the amplitude of turbulence, or of the opacity if the turbulence is unknown.
constexpr std::array<float, 2> kIceBillowsTurbulence = {0.3F, 0.7F};
constexpr int kTurbulenceReach = 2;  // cells
// Detail is attenuated where a cell's opacity is below kThinOpacity. The opacity is taken along the
// cell or along kThinLength_m, whichever is longer.
constexpr float kThinOpacity = 0.3F;
constexpr double kThinLength_m = 200.0;

float Between(const std::array<float, 2>& range, float value) {
  return std::clamp((value - range[0]) / (range[1] - range[0]), 0.0F, 1.0F);
}

// Replaces each value by of(before, here, after) along one axis. At both ends of the axis the
// missing neighbour is replaced by the outermost value.
template <typename Of>
void Along(const glm::ivec3& cells, int axis, const Of& of, Values* values) {
  const std::array<std::size_t, 3> size = {static_cast<std::size_t>(cells.x),
                                           static_cast<std::size_t>(cells.y),
                                           static_cast<std::size_t>(cells.z)};
  const std::array<std::size_t, 3> strides = {1, size[0], size[0] * size[1]};
  const auto along = static_cast<std::size_t>(axis);
  const std::size_t stride = strides[along];
  const std::size_t count = size[along];
  const std::size_t inner = axis == 0 ? 1 : stride;
  const std::size_t outer = values->size() / (count * inner);
  Values before(inner);
  Values here(inner);
  for (std::size_t block = 0; block < outer; ++block) {
    float* row = values->data() + block * count * inner;
    std::copy(row, row + inner, before.begin());
    for (std::size_t i = 0; i < count; ++i, row += inner) {
      const float* after = i + 1 < count ? row + inner : row;
      std::copy(row, row + inner, here.begin());
      for (std::size_t k = 0; k < inner; ++k) row[k] = of(before[k], here[k], after[k]);
      std::swap(before, here);
    }
  }
}

template <typename Of>
void AlongAll(const glm::ivec3& cells, const Of& of, Values* values) {
  for (int axis = 0; axis < 3; ++axis) Along(cells, axis, of, values);
}

void Spread(const glm::ivec3& cells, Values* values) {
  AlongAll(
      cells, [](float a, float b, float c) { return std::max(std::max(a, b), c); }, values);
}

void Smooth(const glm::ivec3& cells, Values* values) {
  AlongAll(
      cells, [](float a, float b, float c) { return 0.25F * a + 0.5F * b + 0.25F * c; }, values);
}

double CellSize_m(const RegularGrid& grid) {
  return std::cbrt(grid.spacing_m.x * grid.spacing_m.y * grid.spacing_m.z);
}

float OpacityOf(float depth) { return depth / (kHalfOpaqueDepth + depth); }

// Returns the opacity along a path that is `times` times as long as the path of `opacity`.
float OnLongerPath(float opacity, float times) {
  const float opaque = times * opacity;
  return opaque / (1.0F - opacity + opaque);
}

struct Opacities {
  Values all;    // opacity tau / (kHalfOpaqueDepth + tau), from the optical depth tau along a cell
  Values cloud;  // optical depths of cloud water
  Values ice;    // optical depths of ice, snow, graupel and hail
};

Opacities OpacitiesOf(const HydrometeorFields& fields, const std::vector<ExtinctionTerm>& terms,
                      const ExtinctionVolume& volume) {
  const RegularGrid& grid = volume.grid;
  const auto cell_m = static_cast<float>(CellSize_m(grid));
  const glm::ivec3 low(
      glm::round((grid.low_corner_m - fields.grid.low_corner_m) / fields.grid.spacing_m));
  const std::size_t count = grid.CellCount();
  Opacities opacities{Values(count), Values(count), Values(count)};
  for (const ExtinctionTerm& term : terms) {
    const HydrometeorField& field = fields.fields[static_cast<std::size_t>(term.field)];
    if (field.concentration_kg_per_m3.empty()) continue;
    const bool cloud = field.hydrometeor == physics::Hydrometeor::kCloud;
    const bool rain = field.hydrometeor == physics::Hydrometeor::kRain;
    Values& into = cloud ? opacities.cloud : rain ? opacities.all : opacities.ice;
    for (int z = 0; z < grid.cells.z; ++z) {
      for (int y = 0; y < grid.cells.y; ++y) {
        AddExtinction(field, {term.mass_extinction_m2_per_kg * cell_m, term.by_cell},
                      fields.grid.Offset(low.x, low.y + y, low.z + z),
                      static_cast<std::size_t>(grid.cells.x), into.data() + grid.Offset(0, y, z));
      }
    }
  }
  const float negligible = volume.negligible_per_m * cell_m;
  for (std::size_t i = 0; i < count; ++i) {
    const float depth = opacities.all[i] + opacities.cloud[i] + opacities.ice[i];
    opacities.all[i] = depth > negligible ? OpacityOf(depth) : 0.0F;
  }
  return opacities;
}

// Returns the part of `values`, given on the fields' grid, that lies on the volume's grid `grid`.
Values Cut(const HydrometeorFields& fields, const std::vector<std::uint8_t>& values,
           const RegularGrid& grid) {
  const glm::ivec3 low(
      glm::round((grid.low_corner_m - fields.grid.low_corner_m) / fields.grid.spacing_m));
  Values cut(grid.CellCount());
  for (int z = 0; z < grid.cells.z; ++z) {
    for (int y = 0; y < grid.cells.y; ++y) {
      const std::uint8_t* row = values.data() + fields.grid.Offset(low.x, low.y + y, low.z + z);
      std::copy(row, row + grid.cells.x, cut.data() + grid.Offset(0, y, z));
    }
  }
  return cut;
}

// Estimates the amplitude of turbulence from the contrast of opacity between neighbouring cells. A
// large contrast suggests that clear air is being mixed into the cloud.
Values ContrastOf(const RegularGrid& grid, const Values& opacity, const Values& around) {
  Values contrast = opacity;
  AlongAll(
      grid.cells, [](float a, float b, float c) { return std::min(std::min(a, b), c); }, &contrast);
  for (std::size_t i = 0; i < contrast.size(); ++i) {
    contrast[i] = around[i] > 0.0F ? kGradientAmplitude * (1.0F - contrast[i] / around[i]) : 0.0F;
  }
  return contrast;
}

// Returns the amplitude of turbulence, 0 to 1. `opacity` is the medium's opacity, and `around` is
// the largest opacity of the neighbourhood.
Values TurbulenceOf(const HydrometeorFields& fields, const RegularGrid& grid, const Values& opacity,
                    const Values& around) {
  Values turbulence;
  if (!fields.motion.turbulence.empty()) {
    turbulence = Cut(fields, fields.motion.turbulence, grid);
    for (float& value : turbulence) value /= 255.0F;
  } else {
    turbulence = ContrastOf(grid, opacity, around);
  }
  // Eddies reach beyond the cells that make them.
  for (int i = 0; i < kTurbulenceReach; ++i) Spread(grid.cells, &turbulence);
  return turbulence;
}

std::uint8_t ByteOf(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F)));
}

}  // namespace

DetailControl DetailControlOf(const HydrometeorFields& fields,
                              const std::vector<ExtinctionTerm>& terms,
                              const ExtinctionVolume& volume) {
  const RegularGrid& grid = volume.grid;
  const Opacities opacities = OpacitiesOf(fields, terms, volume);
  const Values& opacity = opacities.all;
  Values around = opacity;
  Spread(grid.cells, &around);
  Values profile(opacity.size());
  for (std::size_t i = 0; i < profile.size(); ++i) {
    if (opacity[i] > 0.0F) profile[i] = std::min(opacity[i] / (kFullShare * around[i]), 1.0F);
  }
  for (int i = 0; i < kProfileSmoothings; ++i) Smooth(grid.cells, &profile);

  Values amplitude = TurbulenceOf(fields, grid, opacity, around);
  Values ascent_m_per_s;
  if (!fields.motion.ascent.empty()) {
    ascent_m_per_s = Cut(fields, fields.motion.ascent, grid);
    for (float& value : ascent_m_per_s) value *= kAscentUnit_m_per_s;
    Spread(grid.cells, &ascent_m_per_s);
  }
  const auto lengthening = static_cast<float>(std::max(kThinLength_m / CellSize_m(grid), 1.0));
  const bool measured = fields.motion.source != TurbulenceSource::kGradient;
  // Empty cells take the amplitude of their neighbours, because shaders interpolate the amplitude
  // between empty and occupied cells.
  Values weight(amplitude.size());
  for (std::size_t i = 0; i < amplitude.size(); ++i) {
    const float cloud = opacities.cloud[i];
    const float ice = opacities.ice[i];
    const bool rises = !ascent_m_per_s.empty();
    const float condenses = rises ? Between(kCondensing_m_per_s, ascent_m_per_s[i]) : 1.0F;
    const float towers = rises ? Between(kIceBillows_m_per_s, ascent_m_per_s[i]) : 0.0F;
    const float shown = cloud + ice;
    // A cell looks fully liquid if cloud water causes at least half of the extinction.
    const float liquid = shown > 0.0F ? std::min(2.0F * cloud / shown, 1.0F) : 0.0F;
    const float stirred = Between(kIceBillowsTurbulence, measured ? amplitude[i] : around[i]);
    const float billows = std::max({liquid * condenses, towers, stirred});
    // Rain has neither billows nor fibres.
    const float kind = shown > 0.0F ? billows - (1.0F - liquid) * (1.0F - billows) : 0.0F;
    weight[i] = opacity[i];
    const float thick = std::min(OnLongerPath(around[i], lengthening) / kThinOpacity, 1.0F);
    amplitude[i] *= thick * kind * weight[i];
  }
  Smooth(grid.cells, &amplitude);
  Smooth(grid.cells, &weight);
  DetailControl texels(amplitude.size());
  for (std::size_t i = 0; i < amplitude.size(); ++i) {
    texels[i].profile = ByteOf(255.0F * profile[i]);
    if (opacity[i] > 0.0F) texels[i].occupied = 255;
    if (weight[i] > 0.0F) {
      texels[i].amplitude = ByteOf(DetailTexel::kNoAmplitude + 127.0F * amplitude[i] / weight[i]);
    }
  }
  return texels;
}

}  // namespace thunderhead::volume
