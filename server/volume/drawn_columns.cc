#include "volume/drawn_columns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "base/simd.h"
#include "glm/common.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::volume {
namespace {

// The first indices of the point sequence in a column. Probes start at another index than sums, so
// that they use different points.
constexpr std::uint32_t kFirstPoint = 0;
constexpr std::uint32_t kFirstProbe = 1U << 31U;

// Maximum number of points in a cell with an error target. If a cell needs more points, its
// column's error is a little larger than the target. A larger maximum would not make more columns
// keep their water path.
constexpr double kMostInCell = 1024.0;

// The value of DetailTexel::profile above which billows remove no medium.
constexpr std::uint8_t kInside = 250;

using SimdNumbers = std::array<float, base::kSimdWidth>;

float Total(const SimdNumbers& numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), 0.0F);
}

// Returns a point of a sequence that fills a square evenly: multiples of 1 / 1.3247 and of its
// square, modulo 1. The number 1.3247 solves x^3 = x + 1.
glm::vec2 AcrossAt(std::uint32_t index) {
  constexpr std::uint32_t kStepX = 3242174889U;  // in units of 2^-32
  constexpr std::uint32_t kStepY = 2447445414U;
  const auto of_one = [](std::uint32_t value) {
    return static_cast<float>(static_cast<std::int32_t>(value >> 1U)) * 0x1p-31F;
  };
  return {of_one(index * kStepX), of_one(index * kStepY)};
}

// Adds up points of a column, eight at a time.
class PointSum {
 public:
  // Points of all cells together are spread evenly across the column. They start at index `first`
  // of the sequence.
  PointSum(const DrawnMedium& medium, const glm::ivec2& column, std::size_t channels,
           std::uint32_t first)
      : medium_(medium), corner_(column), channels_(channels), next_(first) {}

  // Adds `count` points in the cell at `level`, each with the weight `weight`.
  void AddCell(int level, int count, float weight) {
    for (int i = 0; i < count; ++i) {
      const float up = (static_cast<float>(i) + 0.5F) / static_cast<float>(count);
      Add(AcrossAt(next_++), static_cast<float>(level) + up, weight);
    }
  }

  DrawnColumn Sum() {
    if (count_ > 0) {
      std::fill(weights_.begin() + static_cast<std::ptrdiff_t>(count_), weights_.end(), 0.0F);
      AddPoints();
    }
    DrawnColumn column;
    std::transform(sums_.begin(), sums_.end(), column.sums.begin(), Total);
    std::transform(shares_.begin(), shares_.end(), column.shares.begin(), Total);
    return column;
  }

  // Returns the weighted values of the last eight points, all channels together. Points are
  // evaluated in groups of eight, so the most recent points may still be missing.
  const SimdNumbers& Last() const { return last_; }

 private:
  // `across` is the position relative to the column's corner, and `z` the height above the volume's
  // low corner. Both are in cells.
  void Add(const glm::vec2& across, float z, float weight) {
    const std::size_t point = count_++;
    places_.x[point] = corner_.x + across.x;
    places_.y[point] = corner_.y + across.y;
    places_.z[point] = z;
    weights_[point] = weight;
    from_middle_[0][point] = across.x - 0.5F;
    from_middle_[1][point] = across.y - 0.5F;
    if (count_ == weights_.size()) AddPoints();
  }

  // Returns the weights of a linear interpolation between three columns, at places in the middle
  // column.
  static std::array<SimdNumbers, 3> InterpolationAt(const SimdNumbers& from_middle) {
    std::array<SimdNumbers, 3> weights;
    for (std::size_t point = 0; point < from_middle.size(); ++point) {
      weights[0][point] = std::max(-from_middle[point], 0.0F);
      weights[1][point] = 1.0F - std::abs(from_middle[point]);
      weights[2][point] = std::max(from_middle[point], 0.0F);
    }
    return weights;
  }

  void AddPoints() {
    count_ = 0;
    DrawnMedium::ChannelsAt here;
    medium_.At(places_, &here);
    last_ = {};
    for (std::size_t i = 0; i < channels_; ++i) {
      for (std::size_t point = 0; point < last_.size(); ++point) {
        const float part = here[i][point] * weights_[point];
        sums_[i][point] += part;
        last_[point] += part;
      }
    }
    const std::array<SimdNumbers, 3> x = InterpolationAt(from_middle_[0]);
    const std::array<SimdNumbers, 3> y = InterpolationAt(from_middle_[1]);
    for (std::size_t k = 0; k < shares_.size(); ++k) {
      for (std::size_t point = 0; point < last_.size(); ++point) {
        shares_[k][point] += last_[point] * x[k % 3][point] * y[k / 3][point];
      }
    }
  }

  const DrawnMedium& medium_;
  const glm::vec2 corner_;
  const std::size_t channels_;
  std::uint32_t next_;
  std::size_t count_ = 0;  // points in the SIMD numbers
  DrawnMedium::Places places_{};
  SimdNumbers weights_{};
  std::array<SimdNumbers, 2> from_middle_{};
  SimdNumbers last_{};
  std::array<SimdNumbers, kMaxChannels> sums_{};
  std::array<SimdNumbers, 9> shares_{};
};

// Statistics of the medium at a few points of a cell, with all channels added up.
struct Probe {
  double mean = 0.0;
  double spread = 0.0;  // standard deviation
};

Probe ProbeOf(const SimdNumbers& points) {
  constexpr double kCount = base::kSimdWidth;
  const double mean = Total(points) / kCount;
  const double square = std::inner_product(points.begin(), points.end(), points.begin(), 0.0F);
  return {mean, std::sqrt(std::max(square / kCount - mean * mean, 0.0))};
}

// Rounds a number of points up to a multiple of the SIMD width. Small rounding differences between
// processors therefore hardly ever change the result.
int RoundedUpToSimdWidth(double count) {
  constexpr auto kWidth = static_cast<double>(base::kSimdWidth);
  return static_cast<int>(kWidth * std::ceil(count / kWidth));
}

}  // namespace

DrawnColumns::DrawnColumns(const DetailControl& control, const PlacedDetail& detail,
                           const ExtinctionVolume& volume)
    : medium_(control, detail, volume),
      control_(control),
      grid_(volume.grid),
      channels_(static_cast<std::size_t>(volume.Channels())),
      cell_depth_(volume.extinction_per_m * volume.grid.spacing_m.z),
      occupied_(volume.grid.Offset(0, 0, 1), {volume.grid.cells.z, 0}) {
  for (int z = 0; z < grid_.cells.z; ++z) {
    const DetailTexel* texels = control.data() + grid_.Offset(0, 0, z);
    for (std::size_t column = 0; column < occupied_.size(); ++column) {
      if (texels[column].occupied == 0) continue;
      occupied_[column].begin = std::min(occupied_[column].begin, z);
      occupied_[column].end = z + 1;
    }
  }
}

DrawnColumn DrawnColumns::Sum(const glm::ivec2& column, const ColumnPoints& points) const {
  const Levels levels = LevelsOf(column);
  std::vector<double> by_error(static_cast<std::size_t>(std::max(levels.end - levels.begin, 0)));
  if (points.error > 0.0) by_error = PointsByError(column, levels, points);
  PointSum sum(medium_, column, channels_, kFirstPoint);
  for (int z = levels.begin; z < levels.end; ++z) {
    const bool surface = HasSurface({column.x, column.y, z});
    const double wanted = by_error[static_cast<std::size_t>(z - levels.begin)];
    const int least = surface ? points.at_surface : points.elsewhere;
    const int count = wanted > least ? RoundedUpToSimdWidth(std::min(wanted, kMostInCell)) : least;
    sum.AddCell(z, count, 1.0F / static_cast<float>(count));
  }
  return sum.Sum();
}

// Returns the number of points for each cell, in proportion to the standard deviation in the cell.
// This allocation reaches a given error with the fewest points (Neyman's allocation). The deviation
// is measured at other points than those of the sum. With the same points, both the mean and the
// deviation would be too small in a cell whose points miss the medium.
std::vector<double> DrawnColumns::PointsByError(const glm::ivec2& column, const Levels& levels,
                                                const ColumnPoints& points) const {
  std::vector<double> counts;
  double all = 0.0;
  double spread = 0.0;
  PointSum sum(medium_, column, channels_, kFirstProbe);
  for (int z = levels.begin; z < levels.end; ++z) {
    sum.AddCell(z, base::kSimdWidth, 1.0F);
    const Probe probe = ProbeOf(sum.Last());
    all += probe.mean;
    spread += probe.spread;
    counts.push_back(probe.spread);
  }
  if (spread == 0.0) return counts;
  const double deviations = spread / (points.error * std::max(all, 1.0 / cell_depth_));
  const double wanted = std::min(deviations * deviations, static_cast<double>(points.most));
  for (double& count : counts) count *= wanted / spread;
  return counts;
}

DrawnColumns::Levels DrawnColumns::LevelsOf(const glm::ivec2& column) const {
  const glm::ivec3& size = grid_.cells;
  Levels around = {size.z, 0};
  for (int y = std::max(column.y - 1, 0); y <= std::min(column.y + 1, size.y - 1); ++y) {
    for (int x = std::max(column.x - 1, 0); x <= std::min(column.x + 1, size.x - 1); ++x) {
      const Levels& levels = occupied_[grid_.Offset(x, y, 0)];
      around.begin = std::min(around.begin, levels.begin);
      around.end = std::max(around.end, levels.end);
    }
  }
  // Interpolation also reads one level below and one level above the occupied levels.
  return {std::max(around.begin - 1, 0), std::min(around.end + 1, size.z)};
}

bool DrawnColumns::HasSurface(const glm::ivec3& cell) const {
  const DetailTexel& texel = control_[grid_.Offset(cell.x, cell.y, cell.z)];
  const bool billows = texel.amplitude > DetailTexel::kNoAmplitude;
  return billows && texel.occupied > 0 && texel.profile < kInside;
}

}  // namespace thunderhead::volume
