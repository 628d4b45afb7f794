#include "reference/brick_walk.h"

#include <algorithm>
#include <cmath>

namespace thunderhead::reference {
namespace {

// A horizontal ray through gaps of a periodic medium would never end. It is therefore assumed to
// leave the medium after this many periods. The probability of such a nearly horizontal scattered
// ray is at most about 1e-6.
constexpr double kMaxPeriods = 1e5;

// Clips the interval to the medium's extent along one axis. `inverse` holds the reciprocals of the
// components of the ray's direction.
void ClipAxis(const Ray& ray, const glm::dvec3& inverse, int axis, const Medium& medium,
              RayInterval* interval) {
  const double origin = ray.origin_m[axis];
  const double low = medium.Low_m()[axis];
  const double high = medium.High_m()[axis];
  if (ray.direction[axis] == 0.0) {
    if (origin < low || origin > high) interval->end_m = interval->begin_m;
    return;
  }
  const double to_low = (low - origin) * inverse[axis];
  const double to_high = (high - origin) * inverse[axis];
  interval->begin_m = std::max(interval->begin_m, std::min(to_low, to_high));
  interval->end_m = std::min(interval->end_m, std::max(to_low, to_high));
}

RayInterval ClipBy(const Ray& ray, const glm::dvec3& inverse, const Medium& medium,
                   double limit_m) {
  RayInterval interval{0.0, limit_m};
  const glm::dvec3& low = medium.Low_m();
  const glm::dvec3& high = medium.High_m();
  for (int axis = medium.Periodic() ? 2 : 0; axis < 3; ++axis) {
    ClipAxis(ray, inverse, axis, medium, &interval);
  }
  if (medium.Periodic()) {
    const double period_m = std::max(high.x - low.x, high.y - low.y);
    interval.end_m = std::min(interval.end_m, interval.begin_m + kMaxPeriods * period_m);
  }
  return interval;
}

}  // namespace

RayInterval Clip(const Medium& medium, const Ray& ray, double limit_m) {
  return ClipBy(ray, 1.0 / ray.direction, medium, limit_m);
}

BrickWalk::BrickWalk(const Medium& medium, const Ray& ray, double limit_m, Optics optics)
    : medium_(medium), optics_(optics), ray_(ray), inverse_(1.0 / ray.direction) {
  const RayInterval interval = ClipBy(ray, inverse_, medium, limit_m);
  at_m_ = interval.begin_m;
  end_m_ = interval.end_m;
  if (at_m_ >= end_m_) return;
  for (int axis = 0; axis < 3; ++axis) {
    const double direction = ray.direction[axis];
    step_[axis] = direction > 0.0 ? 1 : (direction < 0.0 ? -1 : 0);
    // delta_m_ is infinite if the ray is perpendicular to the axis.
    delta_m_[axis] = medium.BrickSize_m()[axis] * std::abs(inverse_[axis]);
    Enter(axis);
  }
}

// Finds the brick at `at_m_` and its far face along `axis`.
void BrickWalk::Enter(int axis) {
  const double low_m = medium_.BrickLow_m()[axis];
  const double size_m = medium_.BrickSize_m()[axis];
  const double place =
      (ray_.origin_m[axis] + at_m_ * ray_.direction[axis] - low_m) * medium_.BricksPerM()[axis];
  if (axis == 2 || !medium_.Periodic()) {
    brick_[axis] = std::clamp(static_cast<int>(place), 0, medium_.Bricks()[axis] - 1);
  } else {
    brick_[axis] = static_cast<int>(std::floor(place));
  }
  if (step_[axis] == 0) {
    next_m_[axis] = kEndless_m;
    return;
  }
  const double face_m = low_m + (brick_[axis] + (step_[axis] > 0 ? 1 : 0)) * size_m;
  next_m_[axis] = (face_m - ray_.origin_m[axis]) * inverse_[axis];
}

void BrickWalk::SkipLayer() {
  at_m_ = std::max(at_m_, next_m_.z);
  if (at_m_ >= end_m_) return;
  brick_.z += step_.z;
  next_m_.z += delta_m_.z;
  Enter(0);
  Enter(1);
}

glm::ivec3 BrickWalk::WrappedBrick() const {
  if (!medium_.Periodic()) return brick_;
  const glm::ivec3& bricks = medium_.Bricks();
  const auto wrap = [](int value, int count) {
    const int rest = value % count;
    return rest < 0 ? rest + count : rest;
  };
  return {wrap(brick_.x, bricks.x), wrap(brick_.y, bricks.y), brick_.z};
}

bool BrickWalk::Next(Stretch* stretch) {
  const glm::ivec3& bricks = medium_.Bricks();
  while (at_m_ < end_m_) {
    if (brick_.z < 0 || brick_.z >= bricks.z) break;
    if (medium_.EmptyLayer(brick_.z)) {
      SkipLayer();
      continue;
    }
    const glm::ivec3 here = WrappedBrick();
    if (here.x < 0 || here.x >= bricks.x || here.y < 0 || here.y >= bricks.y) break;
    int axis = next_m_.x < next_m_.y ? 0 : 1;
    if (next_m_.z < next_m_[axis]) axis = 2;
    stretch->begin_m = at_m_;
    stretch->end_m = std::clamp(next_m_[axis], at_m_, end_m_);
    stretch->majorant_per_m = medium_.Majorant_per_m(here, optics_);
    stretch->brick = brick_;
    at_m_ = stretch->end_m;
    brick_[axis] += step_[axis];
    next_m_[axis] += delta_m_[axis];
    if (stretch->majorant_per_m > 0.0 && stretch->end_m > stretch->begin_m) return true;
  }
  at_m_ = end_m_;
  return false;
}

}  // namespace thunderhead::reference
