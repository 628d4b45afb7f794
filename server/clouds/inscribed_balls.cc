#include "clouds/inscribed_balls.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/matrix.hpp"

namespace thunderhead::clouds {
namespace {

constexpr float kFar = 1e18F;         // initial squared distance in m^2, larger than any distance
                                      // in the grid
constexpr float kFlatness = 3.0F;     // width divided by height of the flat ellipsoids
constexpr double kMinInCells = 0.75;  // minimum radius in cells, with which balls of neighbouring
                                      // cells touch

// Computes the lower envelope of parabolas along one line of squared distances.
class LinePass {
 public:
  LinePass(int count, float spacing_m)
      : count_(count),
        spacing_m_(spacing_m),
        line_(static_cast<std::size_t>(count) + 2),
        places_(line_.size()),
        starts_(line_.size() + 1) {}

  // Replaces squared distances along one line. `squared` holds `count` values that are `stride`
  // apart. Beyond both ends of the line the distance is 0, because cells there count as outside the
  // region.
  void Run(float* squared, std::size_t stride) {
    line_.front() = line_.back() = 0.0F;
    for (int i = 0; i < count_; ++i) line_[Index(i + 1)] = squared[Index(i) * stride];
    int last = 0;
    places_[0] = 0;
    starts_[0] = -std::numeric_limits<float>::infinity();
    starts_[1] = std::numeric_limits<float>::infinity();
    for (int i = 1; i < count_ + 2; ++i) {
      float start = Meeting(places_[Index(last)], i);
      while (start <= starts_[Index(last)]) start = Meeting(places_[Index(--last)], i);
      ++last;
      places_[Index(last)] = i;
      starts_[Index(last)] = start;
      starts_[Index(last) + 1] = std::numeric_limits<float>::infinity();
    }
    int at = 0;
    for (int i = 1; i <= count_; ++i) {
      while (starts_[Index(at) + 1] < static_cast<float>(i)) ++at;
      const float away_m = spacing_m_ * static_cast<float>(i - places_[Index(at)]);
      squared[Index(i - 1) * stride] = away_m * away_m + line_[Index(places_[Index(at)])];
    }
  }

 private:
  static std::size_t Index(int i) { return static_cast<std::size_t>(i); }

  // Returns the position, in cells, at which the parabolas of the cells `a` and `b` intersect.
  float Meeting(int a, int b) const {
    const float scale = spacing_m_ * spacing_m_;
    const auto p = static_cast<float>(a);
    const auto q = static_cast<float>(b);
    return ((line_[Index(b)] - line_[Index(a)]) / scale + q * q - p * p) / (2.0F * (q - p));
  }

  int count_;
  float spacing_m_;
  std::vector<float> line_;
  std::vector<int> places_;
  std::vector<float> starts_;
};

// A ball, or an ellipsoid flattened by `flatness`, around a cell's centre.
struct Candidate {
  float radius_m;  // radius of the ball of the same volume
  float flatness;
  std::size_t cell;
};

// Returns one shape for each cell inside the region: the biggest ball or the biggest flat ellipsoid
// that fits around the cell's centre, whichever has the larger volume. The shapes are sorted from
// large to small.
std::vector<Candidate> CandidatesOf(const volume::RegularGrid& grid,
                                    const std::vector<float>& values, float level) {
  std::vector<Candidate> candidates;
  const std::vector<float> round_m = DistanceInside_m(grid, values, level);
  volume::RegularGrid stretched = grid;
  stretched.spacing_m.z *= kFlatness;
  const std::vector<float> flat_m = DistanceInside_m(stretched, values, level);
  const float share = 1.0F / std::cbrt(kFlatness);
  for (std::size_t i = 0; i < round_m.size(); ++i) {
    if (round_m[i] <= 0.0F) continue;
    const float flat = share * flat_m[i];
    candidates.push_back(flat > round_m[i] ? Candidate{flat, kFlatness, i}
                                           : Candidate{round_m[i], 1.0F, i});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.radius_m > b.radius_m; });
  return candidates;
}

glm::ivec3 CellAt(const volume::RegularGrid& grid, std::size_t offset) {
  const auto x = static_cast<std::size_t>(grid.cells.x);
  const auto y = static_cast<std::size_t>(grid.cells.y);
  return {static_cast<int>(offset % x), static_cast<int>(offset / x % y),
          static_cast<int>(offset / (x * y))};
}

glm::dvec3 MiddleOf(const volume::RegularGrid& grid, const glm::ivec3& cell) {
  return grid.low_corner_m + (glm::dvec3(cell) + 0.5) * grid.spacing_m;
}

// Makes the bubble of a candidate. The candidate's radius reaches to the centre of an outside cell,
// but the cloud ends half a cell earlier, so the bubble is smaller by half a cell. No bubble is
// smaller than kMinInCells.
Bubble BubbleOf(const Candidate& candidate, const volume::RegularGrid& grid) {
  const double flatness = candidate.flatness;
  const double height_m = candidate.radius_m / std::cbrt(flatness * flatness);
  const glm::dvec3 inner_m =
      glm::dvec3(flatness, flatness, 1.0) * (height_m - 0.5 * std::min(height_m, grid.spacing_m.z));
  const glm::dvec3 radii_m = glm::max(inner_m, kMinInCells * grid.spacing_m);
  Bubble bubble;
  bubble.centre_m = MiddleOf(grid, CellAt(grid, candidate.cell));
  for (int axis = 0; axis < 3; ++axis) bubble.semi_axes_m[axis][axis] = radii_m[axis];
  return bubble;
}

// Marks the cells in `covered` whose centres are inside `bubble`, scaled by `spacing`.
void Cover(const volume::RegularGrid& grid, const Bubble& bubble, double spacing,
           std::vector<bool>* covered) {
  const glm::dvec3 radii_m(bubble.semi_axes_m[0][0], bubble.semi_axes_m[1][1],
                           bubble.semi_axes_m[2][2]);
  const glm::dvec3 reach = spacing * radii_m / grid.spacing_m;
  const glm::dvec3 middle = (bubble.centre_m - grid.low_corner_m) / grid.spacing_m - 0.5;
  const glm::ivec3 low = glm::max(glm::ivec3(glm::ceil(middle - reach)), glm::ivec3(0));
  const glm::ivec3 high = glm::min(glm::ivec3(glm::floor(middle + reach)), grid.cells - 1);
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) {
        const glm::dvec3 unit = (glm::dvec3(x, y, z) - middle) / reach;
        if (glm::dot(unit, unit) <= 1.0) (*covered)[grid.Offset(x, y, z)] = true;
      }
    }
  }
}

}  // namespace

std::vector<float> DistanceInside_m(const volume::RegularGrid& grid,
                                    const std::vector<float>& values, float level) {
  std::vector<float> squared(values.size());
  std::transform(values.begin(), values.end(), squared.begin(),
                 [level](float value) { return value > level ? kFar : 0.0F; });
  const glm::ivec3& n = grid.cells;
  LinePass along_x(n.x, static_cast<float>(grid.spacing_m.x));
  LinePass along_y(n.y, static_cast<float>(grid.spacing_m.y));
  LinePass along_z(n.z, static_cast<float>(grid.spacing_m.z));
  for (int z = 0; z < n.z; ++z) {
    for (int y = 0; y < n.y; ++y) along_x.Run(&squared[grid.Offset(0, y, z)], 1);
    for (int x = 0; x < n.x; ++x) {
      along_y.Run(&squared[grid.Offset(x, 0, z)], grid.Offset(0, 1, 0));
    }
  }
  for (int y = 0; y < n.y; ++y) {
    for (int x = 0; x < n.x; ++x) {
      along_z.Run(&squared[grid.Offset(x, y, 0)], grid.Offset(0, 0, 1));
    }
  }
  std::transform(squared.begin(), squared.end(), squared.begin(),
                 [](float value) { return std::sqrt(value); });
  return squared;
}

CumulusSurface InscribedBalls(const volume::RegularGrid& grid, const std::vector<float>& values,
                              const InscribedBallsOptions& options) {
  CumulusSurface surface;
  std::vector<bool> covered(values.size(), false);
  for (const Candidate& candidate : CandidatesOf(grid, values, options.level)) {
    if (static_cast<int>(surface.bubbles.size()) >= options.max_balls) break;
    if (covered[candidate.cell]) continue;
    const Bubble bubble = BubbleOf(candidate, grid);
    Cover(grid, bubble, options.spacing, &covered);
    covered[candidate.cell] = true;
    surface.finest_m = RadiusOf(bubble);
    surface.bubbles.push_back(bubble);
  }
  LayOnLarger(&surface);
  return surface;
}

}  // namespace thunderhead::clouds
