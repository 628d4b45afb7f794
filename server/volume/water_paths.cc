#include "volume/water_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <thread>
#include <utility>

#include "base/half_float.h"
#include "glm/common.hpp"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "physics/chunked_work.h"

namespace thunderhead::volume {
namespace {

using Channels = DrawnMedium::Channels;

// Of DetailTexel::column, a byte.
constexpr float kLeastRest = 0.25F;
constexpr float kMostRest = 255.0F / DetailTexel::kColumnOne;

// Of a channel in a column, in the first step, and of its total, in the second.
constexpr float kMostOfColumn = 4.0F;
constexpr double kMostOfChannel = kMaxColumnFactor / kMostOfColumn;

// A profile above which billows leave all that there is.
constexpr std::uint8_t kInside = 250;

// Rounds in which the second step's factors are found; with more, columns keep no more.
constexpr int kTurns = 6;

// The levels of a column at which there is anything, `high` not included.
struct Levels {
  int low = std::numeric_limits<int>::max();
  int high = 0;
};

// The columns of a medium with detail.
class Columns {
 public:
  Columns(const DetailControl& control, const PlacedDetail& detail, const ExtinctionVolume& volume)
      : medium_(control, detail, volume),
        control_(control),
        grid_(volume.grid),
        levels_(volume.grid.Offset(0, 0, 1)) {
    for (int z = 0; z < grid_.cells.z; ++z) {
      const DetailTexel* texels = control.data() + grid_.Offset(0, 0, z);
      for (std::size_t column = 0; column < levels_.size(); ++column) {
        if (texels[column].profile == 0) continue;
        levels_[column].low = std::min(levels_[column].low, z);
        levels_[column].high = z + 1;
      }
    }
  }

  // Calls visit(z) for the levels of column (x, y) that may hold anything.
  template <typename Visit>
  void ForLevels(int x, int y, const Visit& visit) const {
    const Levels levels = LevelsAround(x, y);
    const int end = std::min(levels.high + 1, grid_.cells.z);
    for (int z = std::max(levels.low - 1, 0); z < end; ++z) visit(z);
  }

  // The medium at a place from the middle of a cell, in cells.
  Channels At(const glm::ivec3& cell, const glm::vec3& from_middle) const {
    return medium_.At(glm::vec3(cell) + 0.5F + from_middle);
  }

  // True where billows may end.
  bool HasSurface(const glm::ivec3& cell) const {
    const DetailTexel& texel = control_[grid_.Offset(cell.x, cell.y, cell.z)];
    const bool billows = texel.amplitude > DetailTexel::kNoAmplitude;
    return billows && texel.profile > 0 && texel.profile < kInside;
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
  const DetailControl& control_;
  const RegularGrid& grid_;
  std::vector<Levels> levels_;
};

// Two points in a cell of level z, from its middle: a quarter of a cell off along each axis, and on
// other sides from level to level.
std::array<glm::vec3, 2> TwoPoints(int z) {
  const glm::vec3 point(0.25F, (z & 1) != 0 ? 0.25F : -0.25F, (z & 2) != 0 ? 0.25F : -0.25F);
  return {-point, point};
}

// Nine, three by three across, every other one higher.
std::array<glm::vec3, 9> NinePoints(int z) {
  std::array<glm::vec3, 9> points;
  for (int i = 0; i < 9; ++i) {
    const glm::ivec2 across(i % 3 - 1, i / 3 - 1);
    const float up = ((i + z) & 1) != 0 ? 0.25F : -0.25F;
    points[static_cast<std::size_t>(i)] = {glm::vec2(across) / 3.0F, up};
  }
  return points;
}

// The sum over the levels of a column, by channel.
Channels SumOf(const Columns& columns, int x, int y) {
  Channels sums{};
  columns.ForLevels(x, y, [&](int z) {
    for (const glm::vec3& point : TwoPoints(z)) {
      const Channels here = columns.At({x, y, z}, point);
      for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += here[i] / 2.0F;
    }
  });
  return sums;
}

// Shares of the sum of a column's channels that interpolation takes from the 3 x 3 columns around
// it, x fastest.
using Shares = std::array<float, 9>;

// Weights of linear interpolation at `from_middle` cells from the middle one of three.
std::array<float, 3> LinearWeights(float from_middle) {
  return {std::max(-from_middle, 0.0F), 1.0F - std::abs(from_middle), std::max(from_middle, 0.0F)};
}

// The sums over the levels of a column, as SumOf has them but from more points.
struct Column {
  Channels sums{};
  Shares shares{};
};

Column ColumnOf(const Columns& columns, int x, int y) {
  Column column;
  columns.ForLevels(x, y, [&](int z) {
    const glm::ivec3 cell(x, y, z);
    const auto add = [&](const auto& points) {
      for (const glm::vec3& point : points) {
        const Channels here = columns.At(cell, point);
        float all = 0.0F;
        for (std::size_t i = 0; i < here.size(); ++i) {
          const float part = here[i] / static_cast<float>(points.size());
          column.sums[i] += part;
          all += part;
        }
        const std::array<float, 3> across = LinearWeights(point.x);
        const std::array<float, 3> along = LinearWeights(point.y);
        for (std::size_t k = 0; k < column.shares.size(); ++k) {
          column.shares[k] += all * across[k % 3] * along[k / 3];
        }
      }
    };
    // Inside a cloud, and among fibres, there is nothing as small as the surface of billows.
    if (columns.HasSurface(cell)) {
      add(NinePoints(z));
    } else {
      add(TwoPoints(z));
    }
  });
  return column;
}

int ChannelsOf(const ExtinctionVolume& volume) {
  int channels = 0;
  for (const ExtinctionPlane& plane : volume.planes) channels += plane.channels;
  return channels;
}

float FactorOf(float without, float with) {
  return with > 0.0F ? std::clamp(without / with, 1.0F / kMostOfColumn, kMostOfColumn) : 1.0F;
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

template <typename Work>
void ForColumns(const RegularGrid& grid, const Work& work) {
  const int threads = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
  physics::ForEachChunk(grid.cells.y, {.threads = threads}, [&](int y) {
    for (int x = 0; x < grid.cells.x; ++x) work(x, y);
  });
}

std::vector<float> SumsWith(const DetailControl& control, const PlacedDetail& detail,
                            const ExtinctionVolume& volume) {
  const Columns columns(control, detail, volume);
  const auto channels = static_cast<std::size_t>(ChannelsOf(volume));
  std::vector<float> sums(volume.grid.Offset(0, 0, 1) * channels);
  ForColumns(volume.grid, [&](int x, int y) {
    const Channels column = SumOf(columns, x, y);
    std::copy_n(column.data(), channels, sums.data() + volume.grid.Offset(x, y, 0) * channels);
  });
  return sums;
}

// The second step: factors of columns, linear between their middles, and of channels, with which
// both all channels of each column and all columns of each channel have what they had without
// detail.
class Rests {
 public:
  // `without` are sums by channel and column, as SumsWithout has them.
  Rests(const DetailControl& control, const PlacedDetail& detail, const ExtinctionVolume& volume,
        const std::vector<float>& without)
      : size_(volume.grid.cells),
        of_columns_(volume.grid.Offset(0, 0, 1), 1.0F),
        of_channels_(without.size() / of_columns_.size(), 1.0F),
        shares_(of_columns_.size()),
        sums_(without.size()) {
    const Columns columns(control, detail, volume);
    ForColumns(volume.grid, [&](int x, int y) {
      const std::size_t at = volume.grid.Offset(x, y, 0);
      const Column column = ColumnOf(columns, x, y);
      shares_[at] = column.shares;
      std::copy_n(column.sums.data(), of_channels_.size(), sums_.data() + at * of_channels_.size());
    });
    for (int turn = 0; turn < kTurns; ++turn) {
      FitColumns(without);
      FitChannels(without);
    }
  }

  const std::vector<float>& OfColumns() const { return of_columns_; }
  const std::vector<float>& OfChannels() const { return of_channels_; }

 private:
  // The mean of the factors of a column and of those around it, weighted by what interpolation
  // takes from each.
  float Between(int x, int y) const {
    float with = 0.0F;
    float before = 0.0F;
    const Shares& shares = shares_[static_cast<std::size_t>(y * size_.x + x)];
    for (int k = 0; k < 9; ++k) {
      const int i = std::clamp(x + k % 3 - 1, 0, size_.x - 1);
      const int j = std::clamp(y + k / 3 - 1, 0, size_.y - 1);
      const float share = shares[static_cast<std::size_t>(k)];
      with += share * of_columns_[static_cast<std::size_t>(j * size_.x + i)];
      before += share;
    }
    return before > 0.0F ? with / before : 1.0F;
  }

  void FitColumns(const std::vector<float>& without) {
    std::vector<float> next(of_columns_.size());
    for (std::size_t column = 0; column < next.size(); ++column) {
      float wanted = 0.0F;
      float has = 0.0F;
      for (std::size_t i = 0; i < of_channels_.size(); ++i) {
        wanted += without[column * of_channels_.size() + i];
        has += of_channels_[i] * sums_[column * of_channels_.size() + i];
      }
      const auto at = static_cast<int>(column);
      has *= Between(at % size_.x, at / size_.x);
      next[column] =
          has > 0.0F ? std::clamp(of_columns_[column] * wanted / has, kLeastRest, kMostRest) : 1.0F;
    }
    of_columns_ = std::move(next);
  }

  void FitChannels(const std::vector<float>& without) {
    std::vector<double> wanted(of_channels_.size(), 0.0);
    std::vector<double> has(of_channels_.size(), 0.0);
    for (std::size_t column = 0; column < of_columns_.size(); ++column) {
      const auto at = static_cast<int>(column);
      const float between = Between(at % size_.x, at / size_.x);
      for (std::size_t i = 0; i < of_channels_.size(); ++i) {
        wanted[i] += without[column * of_channels_.size() + i];
        has[i] += between * sums_[column * of_channels_.size() + i];
      }
    }
    for (std::size_t i = 0; i < of_channels_.size(); ++i) {
      of_channels_[i] = has[i] > 0.0
                            ? static_cast<float>(std::clamp(wanted[i] / has[i],
                                                            1.0 / kMostOfChannel, kMostOfChannel))
                            : 1.0F;
    }
  }

  glm::ivec2 size_;
  std::vector<float> of_columns_;
  std::vector<float> of_channels_;
  std::vector<Shares> shares_;  // by column
  std::vector<float> sums_;     // by column, channels beside each other
};

}  // namespace

std::vector<float> KeepWaterPaths(const PlacedDetail& detail, DetailControl* control,
                                  ExtinctionVolume* volume) {
  const std::vector<float> without = SumsWithout(*volume);
  std::vector<float> factors = SumsWith(*control, detail, *volume);
  std::transform(without.begin(), without.end(), factors.begin(), factors.begin(), FactorOf);
  ScaleColumns(factors, volume);
  const Rests rests(*control, detail, *volume, without);
  const std::vector<float>& of_channels = rests.OfChannels();
  std::vector<float> of_totals(factors.size());
  for (std::size_t i = 0; i < factors.size(); ++i) {
    of_totals[i] = of_channels[i % of_channels.size()];
    factors[i] *= of_totals[i];
  }
  ScaleColumns(of_totals, volume);
  for (std::size_t i = 0; i < control->size(); ++i) {
    const float of_column = rests.OfColumns()[i % rests.OfColumns().size()];
    (*control)[i].column =
        static_cast<std::uint8_t>(std::lround(of_column * DetailTexel::kColumnOne));
  }
  return factors;
}

void ScaleColumns(const std::vector<float>& factors, ExtinctionVolume* volume) {
  ForEachTexel(volume->planes, volume->grid.cells.z,
               [&](std::uint16_t& texel, std::size_t channel) {
                 const float product = base::FloatFromHalf(texel) * factors[channel];
                 texel = base::HalfFromFloat(product);
               });
}

}  // namespace thunderhead::volume
