#include "accuracy/probe_cameras.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "glm/trigonometric.hpp"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "scene/view.h"

namespace thunderhead::accuracy {
namespace {

constexpr double kFieldOfView_deg = 20.0;
constexpr double kMaxTurn_deg = 10.0;
constexpr double kMaxTilt_deg = 3.0;
constexpr double kMaxCloser = 0.05;
constexpr double kHighest_deg = 89.0;

// Returns quasirandom points in the unit cube: the R3 sequence (Roberts 2018, "The unreasonable
// effectiveness of quasirandom sequences").
glm::dvec3 Spread(std::uint64_t index) {
  constexpr double kRoot = 1.2207440846057596;  // root of x^4 = x + 1
  const double n = static_cast<double>(index) + 0.5;
  const glm::dvec3 turns = n / glm::dvec3(kRoot, kRoot * kRoot, kRoot * kRoot * kRoot);
  return turns - glm::floor(turns);
}

// A function object that moves a camera of any kind. All kinds turn, tilt and move away by the same
// amounts, as far as they can.
struct Nudge {
  glm::dvec2 middle_m;
  double turn_deg;  // clockwise, seen from above
  double tilt_deg;
  double farther;  // ratio of the new distance to the old

  scene::Camera operator()(scene::OrbitCamera camera) const {
    camera.azimuth_deg += turn_deg;
    camera.elevation_deg = std::clamp(camera.elevation_deg + tilt_deg, -kHighest_deg, kHighest_deg);
    camera.distance_m *= farther;
    return camera;
  }
  scene::Camera operator()(scene::SpotterCamera camera) const {
    const double cosine = std::cos(glm::radians(turn_deg));
    const double sine = std::sin(glm::radians(turn_deg));
    const glm::dvec2 off_m = farther * (camera.place_m - middle_m);
    camera.place_m =
        middle_m + glm::dvec2(off_m.x * cosine + off_m.y * sine, off_m.y * cosine - off_m.x * sine);
    camera.azimuth_deg += turn_deg;
    return camera;
  }
  scene::Camera operator()(scene::TopDownCamera camera) const {
    camera.width_m *= farther;
    return camera;
  }
};

}  // namespace

scene::Camera AroundStorm(const volume::WorldBox& box, double aspect_ratio, std::uint64_t index) {
  const glm::dvec3 spread = Spread(index);
  scene::OrbitCamera camera;
  camera.azimuth_deg = 360.0 * spread.x;
  camera.elevation_deg = std::min(glm::degrees(std::asin(spread.y)), kHighest_deg);
  camera.field_of_view_deg = kFieldOfView_deg;
  return scene::Framing(camera, box.low_m, box.high_m, aspect_ratio);
}

scene::Camera Nudged(const scene::Camera& camera, const volume::WorldBox& box,
                     std::uint64_t index) {
  const glm::dvec3 off = 2.0 * Spread(index) - 1.0;
  return std::visit(Nudge{0.5 * glm::dvec2(box.low_m + box.high_m), kMaxTurn_deg * off.x,
                          kMaxTilt_deg * off.y, 1.0 + kMaxCloser * off.z},
                    camera);
}

}  // namespace thunderhead::accuracy
