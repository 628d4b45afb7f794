#include "volume/drawn_columns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "glm/common.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::volume {
namespace {

constexpr int kMaxPoints = 512;  // in a cell

// A profile above which billows leave all that there is.
constexpr std::uint8_t kInside = 250;

// Adds up points of a column, eight at a time.
class PointSum {
 public:
  PointSum(const DrawnMedium& medium, const glm::ivec2& column, std::size_t channels)
      : medium_(medium), corner_(column), channels_(channels) {}

  // `across` is from the column's corner, `z` from the volume's, in cells.
  void Add(const glm::vec2& across, float z, float weight) {
    const std::size_t lane = count_++;
    places_.x[lane] = corner_.x + across.x;
    places_.y[lane] = corner_.y + across.y;
    places_.z[lane] = z;
    weights_[lane] = weight;
    from_middle_[0][lane] = across.x - 0.5F;
    from_middle_[1][lane] = across.y - 0.5F;
    if (count_ == weights_.size()) AddLanes();
  }

  DrawnColumn Sum() {
    std::fill(weights_.begin() + static_cast<std::ptrdiff_t>(count_), weights_.end(), 0.0F);
    AddLanes();
    const auto total = [](const Lanes& lanes) {
      return std::accumulate(lanes.begin(), lanes.end(), 0.0F);
    };
    DrawnColumn column;
    std::transform(sums_.begin(), sums_.end(), column.sums.begin(), total);
    std::transform(shares_.begin(), shares_.end(), column.shares.begin(), total);
    return column;
  }

 private:
  using Lanes = std::array<float, base::kLanes>;

  // Weights of a linear interpolation between three columns, at places in the middle one.
  static std::array<Lanes, 3> InterpolationAt(const Lanes& from_middle) {
    std::array<Lanes, 3> weights;
    for (std::size_t lane = 0; lane < from_middle.size(); ++lane) {
      weights[0][lane] = std::max(-from_middle[lane], 0.0F);
      weights[1][lane] = 1.0F - std::abs(from_middle[lane]);
      weights[2][lane] = std::max(from_middle[lane], 0.0F);
    }
    return weights;
  }

  void AddLanes() {
    count_ = 0;
    DrawnMedium::ChannelsAt here;
    medium_.At(places_, &here);
    Lanes all{};
    for (std::size_t i = 0; i < channels_; ++i) {
      for (std::size_t lane = 0; lane < all.size(); ++lane) {
        const float part = here[i][lane] * weights_[lane];
        sums_[i][lane] += part;
        all[lane] += part;
      }
    }
    const std::array<Lanes, 3> x = InterpolationAt(from_middle_[0]);
    const std::array<Lanes, 3> y = InterpolationAt(from_middle_[1]);
    for (std::size_t k = 0; k < shares_.size(); ++k) {
      for (std::size_t lane = 0; lane < all.size(); ++lane) {
        shares_[k][lane] += all[lane] * x[k % 3][lane] * y[k / 3][lane];
      }
    }
  }

  const DrawnMedium& medium_;
  const glm::vec2 corner_;
  const std::size_t channels_;
  std::size_t count_ = 0;  // in the lanes
  DrawnMedium::Places places_{};
  Lanes weights_{};
  std::array<Lanes, 2> from_middle_{};
  std::array<Lanes, kMaxChannels> sums_{};
  std::array<Lanes, 9> shares_{};
};

}  // namespace

DrawnColumns::DrawnColumns(const DetailControl& control, const PlacedDetail& detail,
                           const ExtinctionVolume& volume)
    : medium_(control, detail, volume),
      control_(control),
      grid_(volume.grid),
      occupied_(volume.grid.Offset(0, 0, 1), {volume.grid.cells.z, 0}) {
  for (const ExtinctionPlane& plane : volume.planes) {
    channels_ += static_cast<std::size_t>(plane.channels);
  }
  for (int z = 0; z < grid_.cells.z; ++z) {
    const DetailTexel* texels = control.data() + grid_.Offset(0, 0, z);
    for (std::size_t column = 0; column < occupied_.size(); ++column) {
      if (texels[column].occupied == 0) continue;
      occupied_[column].begin = std::min(occupied_[column].begin, z);
      occupied_[column].end = z + 1;
    }
  }
}

// Points of all levels together are spread evenly across the column, at multiples of the powers of
// 1 / 1.3247 (1.3247^3 = 1.3247 + 1).
DrawnColumn DrawnColumns::Sum(const glm::ivec2& column, const ColumnPoints& points) const {
  constexpr std::uint32_t kStepX = 3242174889U;  // of 2^32
  constexpr std::uint32_t kStepY = 2447445414U;
  const auto of_one = [](std::uint32_t value) {
    return static_cast<float>(static_cast<std::int32_t>(value >> 1U)) * 0x1p-31F;
  };
  const auto shared = [](int all, int cells, int least) {
    return std::clamp(all / std::max(cells, 1), least, kMaxPoints);
  };
  const Levels levels = LevelsOf(column);
  int surfaces = 0;
  for (int z = levels.begin; z < levels.end; ++z) {
    surfaces += HasSurface({column.x, column.y, z}) ? 1 : 0;
  }
  const int at_surface = shared(points.at_surfaces, surfaces, points.least_at_surface);
  const int elsewhere = shared(points.elsewhere, levels.end - levels.begin, points.least_elsewhere);
  PointSum sum(medium_, column, channels_);
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  for (int z = levels.begin; z < levels.end; ++z) {
    const int count = HasSurface({column.x, column.y, z}) ? at_surface : elsewhere;
    const float weight = 1.0F / static_cast<float>(count);
    for (int i = 0; i < count; ++i) {
      x += kStepX;
      y += kStepY;
      const float up = (static_cast<float>(i) + 0.5F) * weight;
      sum.Add({of_one(x), of_one(y)}, static_cast<float>(z) + up, weight);
    }
  }
  return sum.Sum();
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
  // Interpolation reaches a level farther.
  return {std::max(around.begin - 1, 0), std::min(around.end + 1, size.z)};
}

bool DrawnColumns::HasSurface(const glm::ivec3& cell) const {
  const DetailTexel& texel = control_[grid_.Offset(cell.x, cell.y, cell.z)];
  const bool billows = texel.amplitude > DetailTexel::kNoAmplitude;
  return billows && texel.occupied > 0 && texel.profile < kInside;
}

}  // namespace thunderhead::volume
