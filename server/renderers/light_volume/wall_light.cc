#include "renderers/light_volume/wall_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "renderers/light_volume/shares.h"

namespace thunderhead::renderers {
namespace {

// Size of a wall relative to the medium's height. It equals the largest horizontal step of light
// (diffuse_light.cc).
constexpr double kWallSize = 0.05;
// A cell belongs to a wall (docs/decisions/0009-diffusion-transport.md) if its transport extinction
// times a wall's size is at least this. Half or twice this value changes the relative errors of
// pictures of the sample storm by 0.01 to 0.03.
constexpr double kWallDepth = 1.345;
// Two walls nearer to each other than this may belong to the same slope. A slope is a smooth cloud
// surface that the grid represents as steps. The limit is the larger of two lengths. The first is
// in units of the shortest path through a cell, the second is a share of a wall's size.
constexpr double kSameSlopeCells = 1.2;
constexpr double kSameSlope = 0.3;
// A wall sees such a near wall only if that wall is at least this many cells above the slope of the
// first wall.
constexpr double kAboveSlope = 0.5;
// Transport optical depth of a cell's shortest side at which half of the light of such a near wall
// counts. In cells with a larger depth, the medium between cell centres is a smooth surface, and
// its steps are artefacts of the grid. In cells with a smaller depth, the steps belong to the cloud
// itself.
constexpr float kSteppedDepth = 1.0F;
constexpr float kMinTransmittance = 0.02F;
constexpr int kTurns = 6;  // number of exchanges of light between walls
constexpr std::size_t kWallsInShare = 1024;
constexpr int kRings = 3;
constexpr int kRaysInRing = 4;

using Rays = std::array<glm::dvec3, static_cast<std::size_t>(kRings* kRaysInRing)>;

// Returns directions from a face. Each direction represents an equal share of the light that a
// white face emits.
Rays RaysFrom(int side) {
  Rays rays;
  const int axis = side / 2;
  for (int ring = 0; ring < kRings; ++ring) {
    const double across = std::sqrt((ring + 0.5) / kRings);
    for (int i = 0; i < kRaysInRing; ++i) {
      const double angle = 2.0 * std::numbers::pi * (i + (ring + 0.5) / kRings) / kRaysInRing;
      glm::dvec3 ray(0.0);
      ray[axis] = (side % 2 == 1 ? 1.0 : -1.0) * std::sqrt(1.0 - across * across);
      ray[(axis + 1) % 3] = across * std::cos(angle);
      ray[(axis + 2) % 3] = across * std::sin(angle);
      rays[static_cast<std::size_t>(ring * kRaysInRing + i)] = ray;
    }
  }
  return rays;
}

// Steps from cell to cell along a ray.
class Walk {
 public:
  Walk(const glm::dvec3& cell_m, const glm::dvec3& start, const glm::ivec3& cell,
       const glm::dvec3& ray)
      : cell_(cell) {
    for (int axis = 0; axis < 3; ++axis) {
      const double per_m = ray[axis] / cell_m[axis];
      step_[axis] = per_m > 0.0 ? 1 : -1;
      const double to_face = (per_m > 0.0 ? cell[axis] + 1.0 : cell[axis]) - start[axis];
      const bool across = std::abs(per_m) < 1e-12;
      next_m_[axis] = across ? 1e30 : std::max(to_face / per_m, 0.0);
      through_m_[axis] = across ? 1e30 : 1.0 / std::abs(per_m);
    }
    shortest_m_ = std::min({through_m_.x, through_m_.y, through_m_.z});
  }

  const glm::ivec3& Cell() const { return cell_; }
  double Gone_m() const { return gone_m_; }
  // Shortest path through a cell along the ray, between opposite faces.
  double ShortestWay_m() const { return shortest_m_; }

  // Moves to the next cell. Returns the path length through the cell that it leaves.
  double Leave() {
    int axis = next_m_.y < next_m_.x ? 1 : 0;
    if (next_m_.z < next_m_[axis]) axis = 2;
    const double way_m = next_m_[axis] - gone_m_;
    gone_m_ = next_m_[axis];
    next_m_[axis] += through_m_[axis];
    cell_[axis] += step_[axis];
    return way_m;
  }

 private:
  glm::ivec3 cell_;
  glm::ivec3 step_{0};
  glm::dvec3 next_m_{0.0};
  glm::dvec3 through_m_{0.0};
  double shortest_m_ = 1.0;
  double gone_m_ = 0.0;
};

}  // namespace

WallLight::WallLight(const DiffusionCells& cells) : hidden_(cells.transport_per_m.size(), 0.0F) {
  wall_size_m_ = kWallSize * cells.cell_m.z * cells.size.z;
  wall_per_m_ = static_cast<float>(kWallDepth / wall_size_m_);
  for (std::size_t i = 0; i < hidden_.size(); ++i) {
    if (IsWall(cells, i)) Look(cells, i);
  }
  NumberWalls();
  beside_walls_ = Fringe(cells, walls_);
}

void WallLight::NumberWalls() {
  constexpr std::int32_t kNone = -1;
  std::vector<std::int32_t> number(hidden_.size(), kNone);
  for (std::size_t n = 0; n < walls_.size(); ++n) {
    number[static_cast<std::size_t>(walls_[n])] = static_cast<std::int32_t>(n);
  }
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    if (i == 0 || seen_[i].from != seen_[i - 1].from) first_seen_.push_back(i);
    seen_[i].to_wall = number[static_cast<std::size_t>(seen_[i].to)];
  }
  first_seen_.push_back(seen_.size());
}

bool WallLight::IsWall(const DiffusionCells& cells, std::size_t cell) const {
  return cells.transport_per_m[cell] > wall_per_m_;
}

void WallLight::Look(const DiffusionCells& cells, std::size_t wall) {
  static const std::array<Rays, 6> kRays = {RaysFrom(0), RaysFrom(1), RaysFrom(2),
                                            RaysFrom(3), RaysFrom(4), RaysFrom(5)};
  const std::size_t before = seen_.size();
  const glm::dvec3 outward = Outward(cells, wall);
  const glm::dvec3 face(cells.cell_m.y * cells.cell_m.z, cells.cell_m.x * cells.cell_m.z,
                        cells.cell_m.x * cells.cell_m.y);
  double open_m2 = 0.0;
  for (int side = 0; side < 6; ++side) {
    glm::ivec3 next = cells.CellAt(wall);
    next[side / 2] += side % 2 == 1 ? 1 : -1;
    if (cells.Contains(next) && IsWall(cells, cells.Offset(next))) continue;
    open_m2 += face[side / 2];
    if (!cells.Contains(next)) continue;
    for (const glm::dvec3& ray : kRays[static_cast<std::size_t>(side)])
      Follow(cells, wall, side, ray, outward);
  }
  for (std::size_t i = before; i < seen_.size(); ++i) {
    seen_[i].share /= static_cast<float>(open_m2);
    hidden_[wall] += seen_[i].share;
  }
  if (seen_.size() > before) walls_.push_back(static_cast<std::int32_t>(wall));
}

// Returns the outward direction, of any length, of the slope that a wall belongs to. It is computed
// from the walls around it.
glm::dvec3 WallLight::Outward(const DiffusionCells& cells, std::size_t wall) const {
  glm::dvec3 outward(0.0);
  const glm::ivec3 middle = cells.CellAt(wall);
  for (int i = 0; i < 27; ++i) {
    const glm::ivec3 step(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (step == glm::ivec3(0) || !cells.Contains(middle + step)) continue;
    if (!IsWall(cells, cells.Offset(middle + step))) continue;
    outward -= glm::normalize(glm::dvec3(step) * cells.cell_m);
  }
  return outward;
}

// Returns how much of the light between a wall and a near wall at `other` counts, from 0 to 1.
float WallLight::NearShare(const DiffusionCells& cells, std::size_t wall, const glm::ivec3& other,
                           const glm::dvec3& outward) {
  const glm::dvec3 way_m = glm::dvec3(other - cells.CellAt(wall)) * cells.cell_m;
  const double cell_m = glm::dot(glm::abs(outward), cells.cell_m);
  if (glm::dot(way_m, outward) <= kAboveSlope * cell_m) return 0.0F;
  const double side_m = std::min({cells.cell_m.x, cells.cell_m.y, cells.cell_m.z});
  const float depth = cells.transport_per_m[wall] * static_cast<float>(side_m) / kSteppedDepth;
  return 1.0F / (1.0F + depth * depth * depth * depth);
}

void WallLight::Follow(const DiffusionCells& cells, std::size_t wall, int side,
                       const glm::dvec3& ray, const glm::dvec3& outward) {
  const int axis = side / 2;
  glm::ivec3 first = cells.CellAt(wall);
  first[axis] += side % 2 == 1 ? 1 : -1;
  glm::dvec3 start = glm::dvec3(first) + 0.5;
  start[axis] += side % 2 == 1 ? -0.5 : 0.5;
  Walk walk(cells.cell_m, start, first, ray);
  const double near_m = std::max(kSameSlopeCells * walk.ShortestWay_m(), kSameSlope * wall_size_m_);
  float transmittance = 1.0F;
  while (cells.Contains(walk.Cell()) && transmittance > kMinTransmittance) {
    const std::size_t here = cells.Offset(walk.Cell());
    if (IsWall(cells, here)) {
      if (walk.Gone_m() < near_m) transmittance *= NearShare(cells, wall, walk.Cell(), outward);
      if (transmittance <= kMinTransmittance) return;
      const double face_m2 = cells.cell_m.x * cells.cell_m.y * cells.cell_m.z / cells.cell_m[axis];
      const auto share = static_cast<float>(face_m2 / (kRings * kRaysInRing)) * transmittance;
      seen_.push_back({static_cast<std::int32_t>(wall), static_cast<std::int32_t>(here), share});
      return;
    }
    transmittance *= std::exp(-static_cast<float>(walk.Leave()) * cells.transport_per_m[here]);
  }
}

void WallLight::FindArriving(const std::vector<float>& own, std::vector<float>* arriving) const {
  std::vector<float> by_wall(walls_.size(), 0.0F);
  std::vector<float> next(walls_.size());
  for (int turn = 0; turn < kTurns && !seen_.empty(); ++turn) {
    ForShares(
        walls_.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t wall = begin; wall < end; ++wall) {
            float sum = 0.0F;
            for (std::size_t i = first_seen_[wall]; i < first_seen_[wall + 1]; ++i) {
              const Seen& seen = seen_[i];
              const float back =
                  seen.to_wall < 0 ? 0.0F : by_wall[static_cast<std::size_t>(seen.to_wall)];
              sum += seen.share * std::max(own[static_cast<std::size_t>(seen.to)] + back, 0.0F);
            }
            next[wall] = sum;
          }
        },
        kWallsInShare);
    std::swap(by_wall, next);
  }
  for (std::size_t wall = 0; wall < walls_.size(); ++wall) {
    (*arriving)[static_cast<std::size_t>(walls_[wall])] = by_wall[wall];
  }
  beside_walls_.Spread(arriving);
}

}  // namespace thunderhead::renderers
