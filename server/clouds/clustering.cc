#include "clouds/clustering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "physics/chunked_work.h"
#include "physics/counter_random.h"

namespace thunderhead::clouds {
namespace {

// The least number of points in a group. All points of a group are assigned to centres before the
// centres move. This is a good approximation, because a centre moves only a little within one
// group. Larger groups can use more threads.
constexpr std::size_t kGroup = 8192;

// Finds the nearest centre, with a grid of cells that hold about two centres each.
class NearestCentre {
 public:
  explicit NearestCentre(const std::vector<glm::dvec3>& centres_m) : centres_m_(centres_m) {
    low_m_ = high_m_ = centres_m.front();
    for (const glm::dvec3& centre : centres_m) {
      low_m_ = glm::min(low_m_, centre);
      high_m_ = glm::max(high_m_, centre);
    }
    const glm::dvec3 size_m = glm::max(high_m_ - low_m_, glm::dvec3(1e-3));
    const double volume = size_m.x * size_m.y * size_m.z;
    cell_m_ = std::cbrt(2.0 * volume / static_cast<double>(centres_m.size()));
    cell_m_ = std::max(cell_m_, std::max({size_m.x, size_m.y, size_m.z}) / 256.0);
    cells_ = glm::ivec3(glm::floor(size_m / cell_m_)) + 1;
    Fill();
  }

  std::uint32_t Find(const glm::dvec3& point_m) const {
    const glm::ivec3 home = CellOf(point_m);
    double best = std::numeric_limits<double>::infinity();
    std::uint32_t nearest = 0;
    const int farthest = std::max({cells_.x, cells_.y, cells_.z});
    for (int ring = 0; ring <= farthest; ++ring) {
      // The distance to all cells of this ring is at least this value.
      const double least_m = (ring - 1) * cell_m_;
      if (ring > 0 && least_m > 0.0 && least_m * least_m > best) break;
      SearchRing(home, ring, point_m, &best, &nearest);
    }
    return nearest;
  }

 private:
  glm::ivec3 CellOf(const glm::dvec3& point_m) const {
    const glm::dvec3 cell = glm::floor((point_m - low_m_) / cell_m_);
    return glm::ivec3(glm::clamp(cell, glm::dvec3(0.0), glm::dvec3(cells_ - 1)));
  }

  std::size_t IndexOf(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(cells_.y) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(cells_.x) +
           static_cast<std::size_t>(x);
  }

  void Fill() {
    const std::size_t count = IndexOf(0, 0, cells_.z);
    starts_.assign(count + 1, 0);
    std::vector<std::size_t> cells;
    for (const glm::dvec3& centre : centres_m_) {
      const glm::ivec3 cell = CellOf(centre);
      cells.push_back(IndexOf(cell.x, cell.y, cell.z));
      ++starts_[cells.back() + 1];
    }
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    members_.resize(centres_m_.size());
    std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      members_[next[cells[i]]++] = static_cast<std::uint32_t>(i);
    }
  }

  void SearchRing(const glm::ivec3& home, int ring, const glm::dvec3& point_m, double* best,
                  std::uint32_t* nearest) const {
    const glm::ivec3 low = glm::max(home - ring, glm::ivec3(0));
    const glm::ivec3 high = glm::min(home + ring, cells_ - 1);
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        const bool face = std::abs(z - home.z) == ring || std::abs(y - home.y) == ring;
        for (int x = low.x; x <= high.x; ++x) {
          if (!face && std::abs(x - home.x) != ring) continue;
          SearchCell(IndexOf(x, y, z), point_m, best, nearest);
        }
      }
    }
  }

  void SearchCell(std::size_t cell, const glm::dvec3& point_m, double* best,
                  std::uint32_t* nearest) const {
    for (std::uint32_t i = starts_[cell]; i < starts_[cell + 1]; ++i) {
      const glm::dvec3 offset_m = centres_m_[members_[i]] - point_m;
      const double square = glm::dot(offset_m, offset_m);
      // If several centres have the same distance, the one with the lowest index is chosen, so that
      // the order of the search does not matter.
      if (square < *best || (square == *best && members_[i] < *nearest)) {
        *best = square;
        *nearest = members_[i];
      }
    }
  }

  const std::vector<glm::dvec3>& centres_m_;
  glm::dvec3 low_m_{0.0};
  glm::dvec3 high_m_{0.0};
  double cell_m_ = 1.0;
  glm::ivec3 cells_{1};
  std::vector<std::uint32_t> starts_;
  std::vector<std::uint32_t> members_;
};

// Applies a Fisher-Yates shuffle. A seed gives the same order on every machine.
std::vector<std::uint32_t> Shuffled(std::size_t count, std::uint64_t seed, std::uint64_t stream) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  physics::CounterRandom random(seed, stream);
  for (std::size_t i = count; i > 1; --i) {
    const auto other = static_cast<std::size_t>(random.Next() * static_cast<double>(i));
    std::swap(order[i - 1], order[other]);
  }
  return order;
}

// Writes to `nearest` the index of the centre that is nearest to each of the points order[first] to
// order[last - 1].
void Assign(const std::vector<glm::vec3>& points_m, const std::vector<std::uint32_t>& order,
            std::size_t first, std::size_t last, const std::vector<glm::dvec3>& centres_m,
            int threads, std::vector<std::uint32_t>* nearest) {
  const NearestCentre search(centres_m);
  nearest->resize(last - first);
  constexpr std::size_t kChunk = 1024;
  const auto chunks = static_cast<int>((last - first + kChunk - 1) / kChunk);
  physics::WorkPlan plan;
  plan.threads = threads;
  physics::ForEachChunk(chunks, plan, [&](int chunk) {
    const std::size_t begin = static_cast<std::size_t>(chunk) * kChunk;
    const std::size_t end = std::min(begin + kChunk, last - first);
    for (std::size_t i = begin; i < end; ++i) {
      (*nearest)[i] = search.Find(glm::dvec3(points_m[order[first + i]]));
    }
  });
}

// Returns the number of points in a group. Groups are larger if there are many centres. Each group
// builds the search structure once, which costs as much as some thousand look-ups.
std::size_t GroupSize(std::size_t points, std::size_t centres) {
  return std::clamp(std::max(kGroup, 2 * centres), std::size_t{1}, points);
}

class Adaptation {
 public:
  Adaptation(const std::vector<glm::vec3>& points_m, const ClusteringOptions& options)
      : points_m_(points_m), options_(options) {
    const std::vector<std::uint32_t> chosen = Shuffled(points_m.size(), options.seed, 0);
    for (int k = 0; k < options.centres; ++k) {
      centres_m_.emplace_back(points_m[chosen[static_cast<std::size_t>(k)]]);
    }
    assigned_.assign(centres_m_.size(), 0);
  }

  // Runs one epoch. Returns false if it was stopped.
  bool RunEpoch(int epoch, const std::function<void(double)>& observer,
                const std::stop_token& stop) {
    // For n(t) of eq. 22, the number of points that were assigned to the centre in all earlier
    // epochs is used. The first epoch uses a running count instead.
    const std::vector<std::int64_t> before = assigned_;
    const std::vector<std::uint32_t> order =
        Shuffled(points_m_.size(), options_.seed, static_cast<std::uint64_t>(epoch) + 1);
    const std::size_t group = GroupSize(points_m_.size(), centres_m_.size());
    for (std::size_t first = 0; first < order.size(); first += group) {
      if (stop.stop_requested()) return false;
      const std::size_t last = std::min(first + group, order.size());
      Assign(points_m_, order, first, last, centres_m_, options_.threads, &nearest_);
      for (std::size_t i = first; i < last; ++i) {
        const std::uint32_t k = nearest_[i - first];
        ++assigned_[k];
        const std::int64_t n = epoch == 0 ? assigned_[k] : std::max<std::int64_t>(before[k], 1);
        const double speed = 1.0 / std::sqrt(static_cast<double>(n));
        centres_m_[k] += speed * (glm::dvec3(points_m_[order[i]]) - centres_m_[k]);
      }
      observer(static_cast<double>(last) / static_cast<double>(order.size()));
    }
    return true;
  }

  // Returns the learning rate of the median centre.
  double Speed() const {
    std::vector<std::int64_t> counts = assigned_;
    const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
    std::nth_element(counts.begin(), middle, counts.end());
    return 1.0 / std::sqrt(static_cast<double>(std::max<std::int64_t>(*middle, 1)));
  }

  std::vector<glm::dvec3>& Centres_m() { return centres_m_; }

 private:
  const std::vector<glm::vec3>& points_m_;
  const ClusteringOptions& options_;
  std::vector<glm::dvec3> centres_m_;
  std::vector<std::int64_t> assigned_;
  std::vector<std::uint32_t> nearest_;
};

std::vector<double> Sigmas(const std::vector<glm::vec3>& points_m,
                           const std::vector<glm::dvec3>& centres_m, double min_sigma_m,
                           int threads) {
  std::vector<std::uint32_t> order(points_m.size());
  std::iota(order.begin(), order.end(), 0U);
  std::vector<std::uint32_t> nearest;
  Assign(points_m, order, 0, order.size(), centres_m, threads, &nearest);
  std::vector<double> squares(centres_m.size(), 0.0);
  std::vector<std::int64_t> counts(centres_m.size(), 0);
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const glm::dvec3 offset_m = glm::dvec3(points_m[i]) - centres_m[nearest[i]];
    squares[nearest[i]] += glm::dot(offset_m, offset_m);
    ++counts[nearest[i]];
  }
  for (std::size_t k = 0; k < squares.size(); ++k) {
    const double mean = counts[k] > 0 ? squares[k] / static_cast<double>(counts[k]) : 0.0;
    squares[k] = std::max(std::sqrt(mean), min_sigma_m);
  }
  return squares;
}

}  // namespace

Clusters Cluster(const std::vector<glm::vec3>& points_m, double min_sigma_m,
                 const ClusteringOptions& options, const ClusteringObserver& observer,
                 const std::stop_token& stop) {
  THUNDERHEAD_CHECK(
      options.centres >= 1 && static_cast<std::size_t>(options.centres) <= points_m.size(),
      std::to_string(options.centres));
  Adaptation adaptation(points_m, options);
  Clusters clusters;
  while (clusters.epochs < options.max_epochs) {
    const auto report = [&](double share) {
      if (observer) observer((clusters.epochs + share) / options.max_epochs);
    };
    if (!adaptation.RunEpoch(clusters.epochs, report, stop)) break;
    ++clusters.epochs;
    const bool slow = adaptation.Speed() < options.min_speed;
    if (slow && clusters.epochs >= options.min_epochs) break;
  }
  clusters.centres_m = std::move(adaptation.Centres_m());
  clusters.sigmas_m = Sigmas(points_m, clusters.centres_m, min_sigma_m, options.threads);
  return clusters;
}

}  // namespace thunderhead::clouds
