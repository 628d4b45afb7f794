#include "volume/water_paths.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <utility>

#include "base/half_float.h"
#include "glm/common.hpp"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "physics/chunked_work.h"
#include "volume/drawn_columns.h"

namespace thunderhead::volume {
namespace {

// The smallest and the largest factor that KeepWaterPaths stores in DetailTexel::column, a byte.
constexpr float kLeastRest = 8.0F / DetailTexel::kColumnOne;
constexpr float kMostRest = 255.0F / DetailTexel::kColumnOne;

// The numbers of points for the first and the second step of KeepWaterPaths.
struct Points {
  ColumnPoints first;
  ColumnPoints second;
};
constexpr ColumnPoints kTwo = {.at_surface = 2, .elsewhere = 2};
constexpr ColumnPoints kFew = {.at_surface = 8, .elsewhere = 2};
constexpr ColumnPoints kMore = {.at_surface = 16, .elsewhere = 4};
constexpr ColumnPoints kMany = {.at_surface = 16, .elsewhere = 4, .error = 0.01, .most = 12000};
constexpr Points kQuickPoints = {kTwo, kFew};

// With more occupied columns than this, each column gets fewer points.
constexpr double kManyColumns = 2e4;

// The largest factor for one channel in one column (first step), and the largest factor for a
// channel's total (second step).
constexpr float kMostOfColumn = 4.0F;
constexpr double kMostOfChannel = kMaxColumnFactor / kMostOfColumn;

// The second step finds its factors in kTurns iterations, and in kMoreTurns iterations each time
// after detail was weakened. Detail is weakened at most kTimesWeaker times. More iterations do not
// help more columns.
constexpr int kTurns = 12;
constexpr int kMoreTurns = 8;
constexpr int kTimesWeaker = 5;

// These constants control the weakening of detail in a column whose water path is too small even
// with the largest factor. Its detail is made so weak that the column would hold kRoom times its
// target, because the detail of neighbouring columns thins it, too. If the column would hold less
// than that even without detail, its detail is removed.
constexpr float kRoom = 3.0F;
constexpr float kNegligible = 0.005F;

float FactorOf(float without, float with) {
  if (without <= 0.0F) return 1.0F;
  return with > 0.0F ? std::clamp(without / with, 1.0F / kMostOfColumn, kMostOfColumn)
                     : kMostOfColumn;
}

// Calls visit(texel, channel of a column) for texels that are not 0. The channels of a column have
// adjacent indices.
template <typename Volume, typename Visit>
void ForEachTexel(Volume& volume, const Visit& visit) {
  const auto all = static_cast<std::size_t>(volume.Channels());
  const std::size_t columns = volume.grid.Offset(0, 0, 1);
  std::size_t first = 0;
  for (auto& plane : volume.planes) {
    const auto channels = static_cast<std::size_t>(plane.channels);
    auto* texel = plane.texels.data();
    for (int z = 0; z < volume.grid.cells.z; ++z) {
      for (std::size_t column = 0; column < columns; ++column) {
        for (std::size_t channel = 0; channel < channels; ++channel, ++texel) {
          if (*texel != 0) visit(*texel, column * all + first + channel);
        }
      }
    }
    first += channels;
  }
}

// Returns for each column and channel the sum over levels without detail, channel fastest, then x.
// Shaders interpolate between columns, so each sum is a mean of the interpolated values within the
// column.
std::vector<float> SumsWithout(const ExtinctionVolume& volume) {
  const auto channels = static_cast<std::size_t>(volume.Channels());
  const glm::ivec3& size = volume.grid.cells;
  std::vector<float> sums(volume.grid.Offset(0, 0, 1) * channels, 0.0F);
  ForEachTexel(volume, [&](std::uint16_t texel, std::size_t channel) {
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

std::vector<float> SumsWith(const DrawnColumns& columns, const ExtinctionVolume& volume,
                            const ColumnPoints& points) {
  const auto channels = static_cast<std::size_t>(volume.Channels());
  std::vector<float> sums(volume.grid.Offset(0, 0, 1) * channels);
  ForColumns(volume.grid, [&](int x, int y) {
    const DrawnColumn column = columns.Sum({x, y}, points);
    std::copy_n(column.sums.data(), channels, sums.data() + volume.grid.Offset(x, y, 0) * channels);
  });
  return sums;
}

// Returns the indices of the columns that contain any medium.
std::vector<std::size_t> FilledColumns(const std::vector<float>& without, std::size_t columns) {
  const std::size_t channels = without.size() / columns;
  std::vector<std::size_t> filled;
  for (std::size_t column = 0; column < columns; ++column) {
    const auto first = without.begin() + static_cast<std::ptrdiff_t>(column * channels);
    const auto last = first + static_cast<std::ptrdiff_t>(channels);
    if (std::any_of(first, last, [](float sum) { return sum > 0.0F; })) filled.push_back(column);
  }
  return filled;
}

// Returns the numbers of points for both steps. `columns` is the number of columns that contain any
// medium.
Points PointsFor(WaterPathEffort effort, std::size_t columns) {
  if (effort == WaterPathEffort::kQuick) return kQuickPoints;
  const double share = kManyColumns / std::max(static_cast<double>(columns), kManyColumns);
  const auto with_fewer = [share](ColumnPoints points) {
    points.at_surface = std::max(static_cast<int>(share * points.at_surface), kFew.at_surface);
    points.elsewhere = std::max(static_cast<int>(share * points.elsewhere), kFew.elsewhere);
    points.error /= std::sqrt(share);
    points.most = static_cast<int>(share * points.most);
    return points;
  };
  return {with_fewer(kMore), with_fewer(kMany)};
}

// The second step of KeepWaterPaths. It finds a factor for each column, interpolated linearly
// between columns, and a factor for each channel. With these factors, the sum of all channels in a
// column, and the sum of a channel over all columns, are the same as without detail.
class Rests {
 public:
  // `without` is the result of SumsWithout. After it was computed, the columns' channels were
  // multiplied by `factors` (first step). All arguments except `filled` (from FilledColumns) must
  // outlive this object.
  Rests(const DrawnColumns& columns, const RegularGrid& grid, const std::vector<float>& without,
        const std::vector<float>& factors, std::vector<std::size_t> filled,
        const ColumnPoints& points)
      : columns_(columns),
        points_(points),
        grid_(grid),
        without_(without),
        factors_(factors),
        of_columns_(grid.Offset(0, 0, 1), 1.0F),
        of_channels_(without.size() / of_columns_.size(), 1.0F),
        drawn_(of_columns_.size()),
        filled_(std::move(filled)) {
    ForColumns(grid_, [&](int x, int y) { Evaluate(x, y); });
    Fit(kTurns);
  }

  // Returns the columns in which even the largest or the smallest allowed factor does not restore
  // the water path. For each column it also returns the share to which the amplitude of detail must
  // be reduced.
  std::vector<WaterPaths::Weaker> ThoseToWeaken() const {
    std::vector<WaterPaths::Weaker> weaker;
    for (const std::size_t column : filled_) {
      const Held held = HeldBy(column);
      const float missing = held.wanted - held.now;
      if (std::abs(missing) <= kNegligible * held.wanted) continue;
      float share = 1.0F;
      if (missing < 0.0F && of_columns_[column] <= kLeastRest) {
        // The displacement moves too much medium into the column. With a smaller amplitude the
        // displacement is smaller.
        share = 0.5F;
      } else if (missing > 0.0F && of_columns_[column] >= kMostRest) {
        const float enough = kRoom * held.wanted;
        share = held.smooth > enough ? (held.smooth - enough) / (held.smooth - held.now) : 0.0F;
      }
      if (share < 1.0F) weaker.push_back({static_cast<std::uint32_t>(column), share});
    }
    return weaker;
  }

  // Fits again after the detail of these columns has been weakened.
  void FitAgain(const std::vector<WaterPaths::Weaker>& weaker) {
    std::vector<bool> changed(of_columns_.size(), false);
    for (const auto& [column, share] : weaker) {
      for (int k = 0; k < 9; ++k) changed[Beside(column, k)] = true;
    }
    ForColumns(grid_, [&](int x, int y) {
      if (changed[grid_.Offset(x, y, 0)]) Evaluate(x, y);
    });
    Fit(kMoreTurns);
  }

  const std::vector<float>& OfColumns() const { return of_columns_; }
  const std::vector<float>& OfChannels() const { return of_channels_; }

 private:
  // Sums over all channels of one column.
  struct Held {
    float wanted = 0.0F;  // the sum without detail, which the factors must restore
    float now = 0.0F;     // the sum with detail and the current factors
    float smooth = 0.0F;  // the sum without detail, with the current factors
  };

  // Returns the index of column `k` of the 3 x 3 columns around a column, x fastest.
  std::size_t Beside(std::size_t column, int k) const {
    const int x = static_cast<int>(column) % grid_.cells.x;
    const int y = static_cast<int>(column) / grid_.cells.x;
    const int i = std::clamp(x + k % 3 - 1, 0, grid_.cells.x - 1);
    const int j = std::clamp(y + k / 3 - 1, 0, grid_.cells.y - 1);
    return grid_.Offset(i, j, 0);
  }

  void Evaluate(int x, int y) { drawn_[grid_.Offset(x, y, 0)] = columns_.Sum({x, y}, points_); }

  Held HeldBy(std::size_t column) const {
    Held held;
    for (std::size_t i = 0; i < of_channels_.size(); ++i) {
      const std::size_t at = column * of_channels_.size() + i;
      held.wanted += without_[at];
      held.now += of_channels_[i] * drawn_[column].sums[i];
      held.smooth += of_channels_[i] * factors_[at] * without_[at];
    }
    const float between = Between(column);
    held.now *= between;
    held.smooth *= between;
    return held;
  }

  // Returns the mean of the factors of a column and its neighbours. Each factor is weighted by its
  // share in the interpolation (DrawnColumn::shares).
  float Between(std::size_t column) const {
    float with = 0.0F;
    float before = 0.0F;
    for (int k = 0; k < 9; ++k) {
      const float share = drawn_[column].shares[static_cast<std::size_t>(k)];
      with += share * of_columns_[Beside(column, k)];
      before += share;
    }
    return before > 0.0F ? with / before : 1.0F;
  }

  void Fit(int turns) {
    for (int turn = 0; turn < turns; ++turn) {
      FitColumns();
      FitChannels();
    }
  }

  void FitColumns() {
    std::vector<float> next(of_columns_.size(), 1.0F);
    for (const std::size_t column : filled_) {
      const Held held = HeldBy(column);
      if (held.wanted <= 0.0F) continue;
      next[column] = held.now > 0.0F ? std::clamp(of_columns_[column] * held.wanted / held.now,
                                                  kLeastRest, kMostRest)
                                     : kMostRest;
    }
    of_columns_ = std::move(next);
  }

  void FitChannels() {
    std::vector<double> wanted(of_channels_.size(), 0.0);
    std::vector<double> has(of_channels_.size(), 0.0);
    for (const std::size_t column : filled_) {
      const float between = Between(column);
      for (std::size_t i = 0; i < of_channels_.size(); ++i) {
        wanted[i] += without_[column * of_channels_.size() + i];
        has[i] += between * drawn_[column].sums[i];
      }
    }
    for (std::size_t i = 0; i < of_channels_.size(); ++i) {
      of_channels_[i] = has[i] > 0.0
                            ? static_cast<float>(std::clamp(wanted[i] / has[i],
                                                            1.0 / kMostOfChannel, kMostOfChannel))
                            : 1.0F;
    }
  }

  const DrawnColumns& columns_;
  const ColumnPoints points_;
  const RegularGrid& grid_;
  const std::vector<float>& without_;
  const std::vector<float>& factors_;
  std::vector<float> of_columns_;
  std::vector<float> of_channels_;
  std::vector<DrawnColumn> drawn_;
  const std::vector<std::size_t> filled_;  // columns
};

void ScaleAmplitudes(const std::vector<WaterPaths::Weaker>& columns, std::size_t count,
                     DetailControl* control) {
  for (const auto& [column, share] : columns) {
    for (std::size_t i = column; i < control->size(); i += count) {
      std::uint8_t& amplitude = (*control)[i].amplitude;
      const float from_none = static_cast<float>(amplitude - DetailTexel::kNoAmplitude);
      amplitude =
          static_cast<std::uint8_t>(DetailTexel::kNoAmplitude + std::lround(share * from_none));
    }
  }
}

// Stores the factor of each column in all its texels. The remainder of rounding to a byte is
// carried over to the next level.
void StoreColumnFactors(const std::vector<float>& factors, DetailControl* control) {
  std::vector<float> left(factors.size(), 0.0F);
  for (std::size_t i = 0; i < control->size(); ++i) {
    const std::size_t column = i % factors.size();
    const float wanted = factors[column] * DetailTexel::kColumnOne + left[column];
    const float byte = std::clamp(std::round(wanted), 0.0F, 255.0F);
    left[column] = wanted - byte;
    (*control)[i].column = static_cast<std::uint8_t>(byte);
  }
}

// Multiplies channels by their factors and stores the columns' factors.
void StoreSecondStep(const WaterPaths& paths, DetailControl* control, ExtinctionVolume* volume) {
  std::vector<float> by_column(paths.by_column.size());
  for (std::size_t i = 0; i < by_column.size(); ++i) {
    by_column[i] = paths.by_channel[i % paths.by_channel.size()];
  }
  ScaleColumns(by_column, volume);
  StoreColumnFactors(paths.drawn, control);
}

}  // namespace

WaterPaths KeepWaterPaths(const PlacedDetail& detail, DetailControl* control,
                          ExtinctionVolume* volume, WaterPathEffort effort) {
  const std::vector<float> without = SumsWithout(*volume);
  const std::size_t count = volume->grid.Offset(0, 0, 1);
  std::vector<std::size_t> filled = FilledColumns(without, count);
  const Points points = PointsFor(effort, filled.size());
  const DrawnColumns columns(*control, detail, *volume);
  WaterPaths paths;
  paths.by_column = SumsWith(columns, *volume, points.first);
  std::transform(without.begin(), without.end(), paths.by_column.begin(), paths.by_column.begin(),
                 FactorOf);
  ScaleColumns(paths.by_column, volume);
  Rests rests(columns, volume->grid, without, paths.by_column, std::move(filled), points.second);
  for (int i = 0; i < kTimesWeaker; ++i) {
    std::vector<WaterPaths::Weaker> weaker = rests.ThoseToWeaken();
    if (weaker.empty()) break;
    ScaleAmplitudes(weaker, count, control);
    rests.FitAgain(weaker);
    paths.weakened.push_back(std::move(weaker));
  }
  paths.by_channel = rests.OfChannels();
  paths.drawn = rests.OfColumns();
  StoreSecondStep(paths, control, volume);
  return paths;
}

void KeepWaterPathsAgain(const WaterPaths& paths, DetailControl* control,
                         ExtinctionVolume* volume) {
  ScaleColumns(paths.by_column, volume);
  for (const auto& weaker : paths.weakened) {
    ScaleAmplitudes(weaker, volume->grid.Offset(0, 0, 1), control);
  }
  StoreSecondStep(paths, control, volume);
}

std::vector<float> WaterPaths::OfVolume() const {
  std::vector<float> factors = by_column;
  for (std::size_t i = 0; i < factors.size(); ++i) factors[i] *= by_channel[i % by_channel.size()];
  return factors;
}

void ScaleColumns(const std::vector<float>& factors, ExtinctionVolume* volume) {
  ForEachTexel(*volume, [&](std::uint16_t& texel, std::size_t channel) {
    texel = base::HalfFromFloat(base::FloatFromHalf(texel) * factors[channel]);
  });
}

}  // namespace thunderhead::volume
