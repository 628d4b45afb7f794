#include "volume/water_paths.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <thread>

#include "glm/common.hpp"
#include "glm/mat3x3.hpp"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "glm/vec4.hpp"
#include "glm/vector_relational.hpp"
#include "physics/chunked_work.h"

namespace thunderhead::volume {
namespace {

constexpr std::size_t kCorners = 8;
constexpr float kLargestHalf = 65504.0F;

float FloatFromHalf(std::uint16_t half) {
  // Moves the exponent from a half's bias to a float's, subnormal halves included.
  return std::bit_cast<float>(static_cast<std::uint32_t>(half) << 13U) * 0x1p112F;
}

// Rounded down. Faster than floor, which is a call without SSE 4.1.
glm::ivec3 Floor(const glm::vec3& value) {
  const glm::ivec3 towards_zero(value);
  return towards_zero - glm::ivec3(glm::lessThan(value, glm::vec3(towards_zero)));
}

// Of a linear interpolation between the corners of a cube; along x, then y, then z.
std::array<float, kCorners> Weights(const glm::vec3& share) {
  const glm::vec3 rest = 1.0F - share;
  std::array<float, kCorners> weights;
  for (std::size_t i = 0; i < kCorners; ++i) {
    weights[i] = ((i & 1U) != 0 ? share.x : rest.x) * ((i & 2U) != 0 ? share.y : rest.y) *
                 ((i & 4U) != 0 ? share.z : rest.z);
  }
  return weights;
}

using Channels = std::array<float, kMaxChannels>;

// The levels of a column at which there is anything, `high` not included.
struct Levels {
  int low = std::numeric_limits<int>::max();
  int high = 0;
};

class DrawnMedium {
 public:
  DrawnMedium(const std::vector<std::uint8_t>& control, const PlacedDetail& detail,
              const ExtinctionVolume& volume)
      : control_(control),
        volume_(volume),
        size_(volume.grid.cells),
        warp_(detail.warp_m / volume.grid.spacing_m),
        fibres_(detail.fibres),
        levels_(volume.grid.Offset(0, 0, 1)) {
    const glm::ivec3 last = size_ - 1;
    for (int i = 0; i < static_cast<int>(kCorners); ++i) {
      const glm::ivec3 corner = glm::min(glm::ivec3(i & 1, i >> 1 & 1, i >> 2), last);
      corners_[static_cast<std::size_t>(i)] = volume.grid.Offset(corner.x, corner.y, corner.z);
    }
    for (const PlacedDetail::Layer& layer : detail.layers) {
      Channels shares{};
      std::copy(layer.shares.begin(), layer.shares.end(), shares.begin());
      layers_.push_back({layer.tile->texels.data(),
                         glm::vec3(volume.grid.low_corner_m / layer.tile_m),
                         glm::vec3(volume.grid.spacing_m / layer.tile_m), shares});
    }
    for (int z = 0; z < size_.z; ++z) {
      const std::uint8_t* texels = control.data() + 2 * volume.grid.Offset(0, 0, z);
      for (std::size_t column = 0; column < levels_.size(); ++column) {
        if (texels[2 * column] == 0) continue;
        levels_[column].low = std::min(levels_[column].low, z);
        levels_[column].high = z + 1;
      }
    }
  }

  // The sum over the levels of column (x, y), by channel. Its points are a quarter of a cell from
  // cells' middles, two in each cell, and change sides from level to level.
  Channels Column(int x, int y) const {
    Channels sums{};
    const Levels levels = LevelsAround(x, y);
    for (int z = std::max(levels.low - 1, 0); z < std::min(levels.high + 1, size_.z); ++z) {
      for (const int side : {-1, 1}) {
        const glm::ivec3 sides(side, (z & 1) != 0 ? side : -side, (z & 2) != 0 ? side : -side);
        AddPoint(glm::vec3(x, y, z) + 0.5F + 0.25F * glm::vec3(sides), &sums);
      }
    }
    for (float& sum : sums) sum /= 2.0F;
    return sums;
  }

 private:
  struct Layer {
    const std::uint8_t* texels;
    glm::vec3 corner;  // of the volume, in tiles
    glm::vec3 cell;    // in tiles
    Channels shares;
  };

  // A linear interpolation between cells.
  struct Place {
    std::size_t cell;  // the lowest
    std::array<float, kCorners> weights;
  };

  Levels LevelsAround(int x, int y) const {
    Levels around;
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, size_.y - 1); ++j) {
      for (int i = std::max(x - 1, 0); i <= std::min(x + 1, size_.x - 1); ++i) {
        const Levels& levels = levels_[volume_.grid.Offset(i, j, 0)];
        around.low = std::min(around.low, levels.low);
        around.high = std::max(around.high, levels.high);
      }
    }
    return around;
  }

  Place PlaceAt(const glm::vec3& in_cells) const {
    const glm::vec3 from_middle =
        glm::clamp(in_cells - 0.5F, glm::vec3(0.0F), glm::vec3(size_ - 1));
    const glm::ivec3 low =
        glm::clamp(glm::ivec3(from_middle), glm::ivec3(0), glm::max(size_ - 2, 0));
    return {volume_.grid.Offset(low.x, low.y, low.z), Weights(from_middle - glm::vec3(low))};
  }

  void AddPoint(const glm::vec3& in_cells, Channels* sums) const {
    const Place here = PlaceAt(in_cells);
    glm::vec2 control(0.0F);
    for (std::size_t i = 0; i < kCorners; ++i) {
      const std::uint8_t* texel = control_.data() + 2 * (here.cell + corners_[i]);
      control += here.weights[i] * glm::vec2(texel[0], texel[1]);
    }
    if (control.x <= 0.0F) return;
    control = {control.x / 255.0F, (control.y - 128.0F) / 127.0F};
    glm::vec3 displaced = in_cells;
    Channels factors;
    factors.fill(1.0F);
    for (const Layer& layer : layers_) {
      const glm::vec4 noise = NoiseAt(layer, in_cells, control.y < 0.0F);
      if (&layer == layers_.data()) {
        displaced += physics::glsl::detail_warp_share(control) * warp_ *
                     (2.0F * glm::vec3(noise.y, noise.z, noise.w) - 1.0F);
      }
      const float change = physics::glsl::detail_factor(control, noise.x, 0.0F) - 1.0F;
      for (std::size_t i = 0; i < factors.size(); ++i) {
        factors[i] *= 1.0F + change * layer.shares[i];
      }
    }
    const Place from = PlaceAt(displaced);
    std::size_t first = 0;
    for (const ExtinctionPlane& plane : volume_.planes) {
      if (plane.channels == 1) Add<1>(plane, from, factors.data() + first, sums->data() + first);
      if (plane.channels == 2) Add<2>(plane, from, factors.data() + first, sums->data() + first);
      if (plane.channels == 4) Add<4>(plane, from, factors.data() + first, sums->data() + first);
      first += static_cast<std::size_t>(plane.channels);
    }
  }

  template <std::size_t kChannels>
  void Add(const ExtinctionPlane& plane, const Place& from, const float* factors,
           float* sums) const {
    std::array<float, kChannels> values{};
    for (std::size_t i = 0; i < kCorners; ++i) {
      const std::uint16_t* texel = plane.texels.data() + kChannels * (from.cell + corners_[i]);
      for (std::size_t channel = 0; channel < kChannels; ++channel) {
        values[channel] += from.weights[i] * FloatFromHalf(texel[channel]);
      }
    }
    for (std::size_t channel = 0; channel < kChannels; ++channel) {
      sums[channel] += factors[channel] * values[channel];
    }
  }

  glm::vec4 NoiseAt(const Layer& layer, const glm::vec3& in_cells, bool fibres) const {
    constexpr int kSide = physics::DetailTile::kSide;
    glm::vec3 tile = layer.corner + in_cells * layer.cell;
    if (fibres) tile = fibres_ * tile;
    const glm::vec3 texel = tile * static_cast<float>(kSide) - 0.5F;
    const glm::ivec3 low = Floor(texel);
    const std::array<float, kCorners> weights = Weights(texel - glm::vec3(low));
    const std::array<glm::ivec3, 2> at = {low & (kSide - 1), (low + 1) & (kSide - 1)};
    glm::vec4 sum(0.0F);
    for (std::size_t i = 0; i < kCorners; ++i) {
      const int row = at[i >> 2U].z * kSide + at[i >> 1U & 1U].y;
      const std::uint8_t* bytes = layer.texels + 4 * (row * kSide + at[i & 1U].x);
      sum += weights[i] * glm::vec4(bytes[0], bytes[1], bytes[2], bytes[3]);
    }
    return sum / 255.0F;
  }

  const std::vector<std::uint8_t>& control_;
  const ExtinctionVolume& volume_;
  glm::ivec3 size_;
  std::array<std::size_t, kCorners> corners_;  // from the lowest
  glm::vec3 warp_;                             // in cells
  glm::mat3 fibres_;
  std::vector<Levels> levels_;
  std::vector<Layer> layers_;
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
    sums[channel] += FloatFromHalf(texel);
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
  const DrawnMedium medium(control, detail, volume);
  const auto channels = static_cast<std::size_t>(ChannelsOf(volume));
  const glm::ivec3& size = volume.grid.cells;
  std::vector<float> sums(volume.grid.Offset(0, 0, 1) * channels);
  const int threads = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
  physics::ForEachChunk(size.y, {.threads = threads}, [&](int y) {
    for (int x = 0; x < size.x; ++x) {
      const Channels column = medium.Column(x, y);
      std::copy_n(column.data(), channels, sums.data() + volume.grid.Offset(x, y, 0) * channels);
    }
  });
  return sums;
}

}  // namespace

void KeepWaterPaths(const std::vector<std::uint8_t>& control, const PlacedDetail& detail,
                    ExtinctionVolume* volume) {
  const std::vector<float> with = SumsWith(control, detail, *volume);
  std::vector<float> factors = SumsWithout(*volume);
  std::transform(factors.begin(), factors.end(), with.begin(), factors.begin(), FactorOf);
  ForEachTexel(volume->planes, volume->grid.cells.z,
               [&](std::uint16_t& texel, std::size_t channel) {
                 const float product = FloatFromHalf(texel) * factors[channel];
                 texel = HalfFromFloat(std::min(product, kLargestHalf));
               });
}

}  // namespace thunderhead::volume
