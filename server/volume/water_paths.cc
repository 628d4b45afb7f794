#include "volume/water_paths.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <thread>

#include "base/half_float.h"
#include "glm/common.hpp"
#include "glm/vec3.hpp"
#include "physics/chunked_work.h"

namespace thunderhead::volume {
namespace {

using Channels = DrawnMedium::Channels;

// The levels of a column at which there is anything, `high` not included.
struct Levels {
  int low = std::numeric_limits<int>::max();
  int high = 0;
};

// Sums over a medium's columns, with detail.
class Columns {
 public:
  Columns(const std::vector<std::uint8_t>& control, const PlacedDetail& detail,
          const ExtinctionVolume& volume)
      : medium_(control, detail, volume), grid_(volume.grid), levels_(volume.grid.Offset(0, 0, 1)) {
    for (int z = 0; z < grid_.cells.z; ++z) {
      const std::uint8_t* texels = control.data() + 2 * grid_.Offset(0, 0, z);
      for (std::size_t column = 0; column < levels_.size(); ++column) {
        if (texels[2 * column] == 0) continue;
        levels_[column].low = std::min(levels_[column].low, z);
        levels_[column].high = z + 1;
      }
    }
  }

  // The sum over the levels of column (x, y), by channel. Its points are a quarter of a cell from
  // cells' middles, two in each cell, and change sides from level to level.
  Channels Sum(int x, int y) const {
    Channels sums{};
    const Levels levels = LevelsAround(x, y);
    for (int z = std::max(levels.low - 1, 0); z < std::min(levels.high + 1, grid_.cells.z); ++z) {
      for (const int side : {-1, 1}) {
        const glm::ivec3 sides(side, (z & 1) != 0 ? side : -side, (z & 2) != 0 ? side : -side);
        const Channels here = medium_.At(glm::vec3(x, y, z) + 0.5F + 0.25F * glm::vec3(sides));
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += here[i] / 2.0F;
      }
    }
    return sums;
  }

 private:
  Levels LevelsAround(int x, int y) const {
    Levels around;
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, grid_.cells.y - 1); ++j) {
      for (int i = std::max(x - 1, 0); i <= std::min(x + 1, grid_.cells.x - 1); ++i) {
        const Levels& levels = levels_[grid_.Offset(i, j, 0)];
        around.low = std::min(around.low, levels.low);
        around.high = std::max(around.high, levels.high);
      }
    }
    return around;
  }

  const DrawnMedium medium_;
  const RegularGrid& grid_;
  std::vector<Levels> levels_;
};

int ChannelsOf(const ExtinctionVolume& volume) {
  int channels = 0;
  for (const ExtinctionPlane& plane : volume.planes) channels += plane.channels;
  return channels;
}

float FactorOf(float without, float with) {
  return with > 0.0F ? std::clamp(without / with, 1.0F / kMaxColumnFactor, kMaxColumnFactor) : 1.0F;
}

// Calls visit(texel, channel of a column), those of a column being beside each other, for texels
// that are not 0.
template <typename Planes, typename Visit>
void ForEachTexel(Planes& planes, int levels, const Visit& visit) {
  std::size_t all = 0;
  for (const ExtinctionPlane& plane : planes) all += static_cast<std::size_t>(plane.channels);
  std::size_t first = 0;
  for (auto& plane : planes) {
    const auto channels = static_cast<std::size_t>(plane.channels);
    const std::size_t columns = plane.texels.size() / channels / static_cast<std::size_t>(levels);
    auto* texel = plane.texels.data();
    for (int z = 0; z < levels; ++z) {
      for (std::size_t column = 0; column < columns; ++column) {
        for (std::size_t channel = 0; channel < channels; ++channel, ++texel) {
          if (*texel != 0) visit(*texel, column * all + first + channel);
        }
      }
    }
    first += channels;
  }
}

// Sums of columns over levels, x fastest, by channel: what linear interpolation has in the middle
// of a quarter of a cell, on the mean.
std::vector<float> SumsWithout(const ExtinctionVolume& volume) {
  const auto channels = static_cast<std::size_t>(ChannelsOf(volume));
  const glm::ivec3& size = volume.grid.cells;
  std::vector<float> sums(volume.grid.Offset(0, 0, 1) * channels, 0.0F);
  ForEachTexel(volume.planes, size.z, [&](std::uint16_t texel, std::size_t channel) {
    sums[channel] += base::FloatFromHalf(texel);
  });
  const auto smooth = [&](std::size_t stride, int count, std::size_t at_first) {
    for (std::size_t channel = 0; channel < channels; ++channel) {
      float before = sums[at_first * channels + channel];
      for (int i = 0; i < count; ++i) {
        float& here = sums[(at_first + static_cast<std::size_t>(i) * stride) * channels + channel];
        const float after = i + 1 < count ? (&here)[stride * channels] : here;
        const float mean = 0.125F * before + 0.75F * here + 0.125F * after;
        before = here;
        here = mean;
      }
    }
  };
  const auto width = static_cast<std::size_t>(size.x);
  for (int y = 0; y < size.y; ++y) smooth(1, size.x, static_cast<std::size_t>(y) * width);
  for (int x = 0; x < size.x; ++x) smooth(width, size.y, static_cast<std::size_t>(x));
  return sums;
}

std::vector<float> SumsWith(const std::vector<std::uint8_t>& control, const PlacedDetail& detail,
                            const ExtinctionVolume& volume) {
  const Columns columns(control, detail, volume);
  const auto channels = static_cast<std::size_t>(ChannelsOf(volume));
  const glm::ivec3& size = volume.grid.cells;
  std::vector<float> sums(volume.grid.Offset(0, 0, 1) * channels);
  const int threads = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
  physics::ForEachChunk(size.y, {.threads = threads}, [&](int y) {
    for (int x = 0; x < size.x; ++x) {
      const Channels column = columns.Sum(x, y);
      std::copy_n(column.data(), channels, sums.data() + volume.grid.Offset(x, y, 0) * channels);
    }
  });
  return sums;
}

}  // namespace

std::vector<float> WaterPathFactors(const std::vector<std::uint8_t>& control,
                                    const PlacedDetail& detail, const ExtinctionVolume& volume) {
  const std::vector<float> with = SumsWith(control, detail, volume);
  std::vector<float> factors = SumsWithout(volume);
  std::transform(factors.begin(), factors.end(), with.begin(), factors.begin(), FactorOf);
  return factors;
}

void ScaleColumns(const std::vector<float>& factors, ExtinctionVolume* volume) {
  ForEachTexel(volume->planes, volume->grid.cells.z,
               [&](std::uint16_t& texel, std::size_t channel) {
                 const float product = base::FloatFromHalf(texel) * factors[channel];
                 texel = base::HalfFromFloat(product);
               });
}

void KeepWaterPaths(const std::vector<std::uint8_t>& control, const PlacedDetail& detail,
                    ExtinctionVolume* volume) {
  ScaleColumns(WaterPathFactors(control, detail, *volume), volume);
}

}  // namespace thunderhead::volume
