#include "physics/perlin.h"

#include <array>

#include "physics/counter_random.h"

namespace thunderhead::physics {
namespace {

constexpr std::array<PerlinGradient, 12> kEdges = {{{1, 1, 0},
                                                    {-1, 1, 0},
                                                    {1, -1, 0},
                                                    {-1, -1, 0},
                                                    {1, 0, 1},
                                                    {-1, 0, 1},
                                                    {1, 0, -1},
                                                    {-1, 0, -1},
                                                    {0, 1, 1},
                                                    {0, -1, 1},
                                                    {0, 1, -1},
                                                    {0, -1, -1}}};

}  // namespace

PerlinOctave MakePerlinOctave(int index, int side, std::uint32_t seed) {
  PerlinOctave octave;
  octave.cells = kPerlinWaves << index;
  octave.texels_per_cell = side / octave.cells;
  const auto count = static_cast<std::size_t>(octave.cells) *
                     static_cast<std::size_t>(octave.cells) *
                     static_cast<std::size_t>(octave.cells);
  for (std::size_t i = 0; i < count; ++i) {
    CounterRandom random(seed, (static_cast<std::uint64_t>(index) << 32U) | i);
    octave.gradients.push_back(kEdges[static_cast<std::size_t>(random.Next() * kEdges.size())]);
  }
  constexpr std::int64_t kFifth = kPerlinPlaceUnits * kPerlinPlaceUnits * kPerlinPlaceUnits *
                                  kPerlinPlaceUnits * kPerlinPlaceUnits;
  for (int i = 0; i < octave.texels_per_cell; ++i) {
    const std::int64_t p = (2 * i + 1) * kPerlinPlaceUnits / (2 * octave.texels_per_cell);
    octave.place.push_back(p);
    const std::int64_t fade =
        p * p * p *
        (6 * p * p - 15 * p * kPerlinPlaceUnits + 10 * kPerlinPlaceUnits * kPerlinPlaceUnits);
    octave.fade.push_back((fade * kPerlinOne + kFifth / 2) / kFifth);
  }
  return octave;
}

PerlinCorner CornerOf(const PerlinOctave& octave, int cell_x, int y, int z) {
  const int in_y = y % octave.texels_per_cell;
  const int in_z = z % octave.texels_per_cell;
  PerlinCorner corner;
  for (int step = 0; step < 4; ++step) {
    const int step_y = step & 1;
    const int step_z = step >> 1;
    const PerlinGradient& gradient =
        octave.At(cell_x, y / octave.texels_per_cell + step_y, z / octave.texels_per_cell + step_z);
    const std::int64_t fade_y = octave.fade[static_cast<std::size_t>(in_y)];
    const std::int64_t fade_z = octave.fade[static_cast<std::size_t>(in_z)];
    const std::int64_t weight =
        (step_y == 1 ? fade_y : kPerlinOne - fade_y) * (step_z == 1 ? fade_z : kPerlinOne - fade_z);
    const std::int64_t from_y =
        octave.place[static_cast<std::size_t>(in_y)] - step_y * kPerlinPlaceUnits;
    const std::int64_t from_z =
        octave.place[static_cast<std::size_t>(in_z)] - step_z * kPerlinPlaceUnits;
    corner.slope += weight * gradient.x;
    corner.offset += weight * (gradient.y * from_y + gradient.z * from_z);
  }
  return corner;
}

}  // namespace thunderhead::physics
