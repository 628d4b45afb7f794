#include "renderers/light_volume/diffuse_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "base/status.h"
#include "glm/geometric.hpp"
#include "physics/optics.h"
#include "renderers/light_volume/shares.h"

namespace thunderhead::renderers {
namespace {

constexpr double kSkyTolerance = 2e-4;
// Maximum factor by which a slanted direction lengthens the path from a face to the cloud's
// surface.
constexpr float kMaxSlant = 4.0F;

// Smaller transmittances of sunlight count as zero.
constexpr float kDarkTransmittance = 1e-12F;

// Light that the six faces of a cell receive from a sky of radiance a + b (1 - sine of the
// elevation). Component x is the weight of the sky's irradiance from above divided by pi, y is the
// weight of its mean radiance. The weights are integrals over a hemisphere. For the vertical faces
// they are integrals over a quarter of the sphere.
constexpr glm::vec2 kSideSees(-0.227F, 0.727F);
constexpr std::array<glm::vec2, 6> kSkySeen = {kSideSees, kSideSees,       kSideSees,
                                               kSideSees, glm::vec2(0.0F), glm::vec2(1.0F, 0.0F)};

// Largest horizontal step of light, as a share of the medium's height. In the diffusion equation,
// light spreads without limit through thin medium. In haze on a thick cloud it would be carried far
// sideways, although in reality it leaves upwards after a short distance. Half or twice this value
// changes the relative errors of pictures of the sample storm by 0.01 to 0.03.
constexpr double kFarthestHop = 0.05;
constexpr float kMinResistance = 1e-3F;

// Returns the mean of exp(-depth) between the optical depths `from` and `to`. `transmittance` is
// exp(-depth) at the smaller of the two.
float MeanTransmittance(float transmittance, float from, float to) {
  return transmittance * physics::glsl::mean_transmittance(std::abs(to - from));
}

}  // namespace

DiffuseLight::DiffuseLight(DiffusionCells cells)
    : cells_(std::move(cells)), walls_(cells_), numbered_(cells_) {
  const glm::dvec3& h = cells_.cell_m;
  area_[0] = static_cast<float>(h.z / h.x);
  area_[1] = static_cast<float>(h.z / h.y);
  area_[2] = 1.0F;
  FindExits();
  Link();
  SolveSky();
  // From here on, extinction is read only from optics_, which is indexed by cell number. The arrays
  // with one value for each cell of the box are therefore freed.
  cells_.light_per_m = std::vector<float>();
  cells_.transport_per_m = std::vector<float>();
  cells_.absorption_per_m = std::vector<float>();
  fluence_.assign(numbered_.Count(), 0.0F);
  values_.assign(numbered_.Count(), 0.0F);
  for (std::vector<float>* values : {&from_walls_, &net_inward_, &at_cells_}) {
    values->assign(numbered_.AllCells(), 0.0F);
  }
}

// Scans the cells for their two exits along `axis`. With the optical depth to an exit, it adds 1 /
// depth^2 of the nearer exit to `sum`, and of both exits to `all`. It sets `outward` along the
// axis, and adds the sky that the exits see to sky_seen_.
void DiffuseLight::ScanExits(int axis, std::vector<float>* sum, std::vector<float>* all,
                             std::vector<glm::vec3>* outward) {
  const int length = cells_.size[axis];
  const std::array<int, 2> other = {(axis + 1) % 3, (axis + 2) % 3};
  glm::ivec3 unit(0);
  unit[axis] = 1;
  const std::size_t stride = cells_.Offset(unit);
  const float half_m = static_cast<float>(0.5 * cells_.cell_m[axis]);
  std::vector<float> down(static_cast<std::size_t>(length));
  for (int a = 0; a < cells_.size[other[0]]; ++a) {
    for (int b = 0; b < cells_.size[other[1]]; ++b) {
      glm::ivec3 start(0);
      start[other[0]] = a;
      start[other[1]] = b;
      const std::size_t first = cells_.Offset(start);
      float depth = 0.0F;
      float before = 0.0F;
      for (std::size_t i = 0; i < down.size(); ++i) {
        const std::size_t cell = first + i * stride;
        const float here = numbered_.IsEmpty(cell) ? 0.0F : cells_.light_per_m[cell];
        depth = before > 0.0F ? depth + half_m * (before + here) : half_m * here;
        down[i] = depth;
        before = here;
      }
      depth = before = 0.0F;
      for (std::size_t i = down.size(); i-- > 0;) {
        const std::size_t cell = first + i * stride;
        const float here = numbered_.IsEmpty(cell) ? 0.0F : cells_.light_per_m[cell];
        depth = before > 0.0F ? depth + half_m * (before + here) : half_m * here;
        before = here;
        const float nearer = std::max(std::min(down[i], depth), 1e-9F);
        (*sum)[cell] += 1.0F / (nearer * nearer);
        const float low = 1.0F / std::max(down[i] * down[i], 1e-18F);
        const float high = 1.0F / std::max(depth * depth, 1e-18F);
        (*all)[cell] += low + high;
        (*outward)[cell][axis] = high - low;
        sky_seen_[cell] += low * kSkySeen[static_cast<std::size_t>(2 * axis)] +
                           high * kSkySeen[static_cast<std::size_t>(2 * axis + 1)];
      }
    }
  }
}

// For a plane surface with normal n, the distance to the surface along axis k is t / |n_k|, where t
// is the shortest distance. The squares of the reciprocal distances therefore add up to 1 / t^2,
// for any direction of the surface.
void DiffuseLight::FindExits() {
  std::vector<float> sum(numbered_.AllCells(), 0.0F);
  std::vector<float> all(numbered_.AllCells(), 0.0F);
  sky_seen_.assign(numbered_.AllCells(), glm::vec2(0.0F));
  std::vector<glm::vec3> outward(numbered_.AllCells(), glm::vec3(0.0F));
  outward_.reserve(numbered_.Count());
  optics_.reserve(numbered_.Count());
  for (int axis = 0; axis < 3; ++axis) ScanExits(axis, &sum, &all, &outward);
  exit_root_.assign(numbered_.AllCells(), 0.0F);
  for (std::size_t n = 0; n < numbered_.Count(); ++n) {
    const std::size_t i = numbered_.CellOf(n);
    exit_root_[i] = std::pow(sum[i], -0.25F);
    sky_seen_[i] /= all[i];
    // If all depths overflow, outward is the zero vector, so that no exit counts as nearer than
    // another.
    outward_.push_back(all[i] > 0.0F ? outward[i] / all[i] : glm::vec3(0.0F));
    const float exit = exit_root_[i] * exit_root_[i];
    optics_.push_back({cells_.light_per_m[i], cells_.absorption_per_m[i], exit,
                       exit * cells_.transport_per_m[i] / cells_.light_per_m[i]});
  }
  for (std::size_t i = 0; i < numbered_.AllCells(); ++i) {
    if (numbered_.IsEmpty(i)) sky_seen_[i] = glm::vec2(0.0F);
  }
}

void DiffuseLight::Link() {
  const double farthest_hop_m = kFarthestHop * cells_.cell_m.z * cells_.size.z;
  std::vector<Links> down(numbered_.Count());
  std::vector<Links> up(numbered_.Count());
  std::vector<float> loss(numbered_.Count());
  slack_.resize(numbered_.Count());
  for (std::size_t n = 0; n < numbered_.Count(); ++n) {
    const std::size_t i = numbered_.CellOf(n);
    const glm::ivec3 cell = cells_.CellAt(i);
    const float here = cells_.transport_per_m[i];
    const float exit = optics_[n].exit;  // optical depth by `light_per_m`, like `out` below
    for (int side = 0; side < 6; ++side) {
      const int axis = side / 2;
      glm::ivec3 next = cell;
      next[axis] += side % 2 == 1 ? 1 : -1;
      const bool inside = next[axis] >= 0 && next[axis] < cells_.size[axis];
      const std::size_t j = inside ? cells_.Offset(next) : 0;
      const std::int32_t to = inside ? numbered_.NumberOf(j) : NumberedCells::kNone;
      const float there = to == NumberedCells::kNone ? 0.0F : cells_.transport_per_m[j];
      const float depth = static_cast<float>(0.5 * cells_.cell_m[axis]) * (here + there);
      const float out = static_cast<float>(0.5 * cells_.cell_m[axis]) * cells_.light_per_m[i];
      float& slack = slack_[n][static_cast<std::size_t>(side)];
      if (to == NumberedCells::kNone) {
        slack = 2.0F * std::clamp(out / exit, 1.0F, kMaxSlant);
      } else {
        slack = axis == 2 ? 0.0F : static_cast<float>(cells_.cell_m[axis] / farthest_hop_m);
      }
      Links& links = side % 2 == 1 ? up[n] : down[n];
      links.to[axis] = to;
      links.conductance[axis] = area_[axis] / std::max(3.0F * depth + slack, kMinResistance);
    }
    loss[n] = static_cast<float>(cells_.cell_m.z) * cells_.absorption_per_m[i];
  }
  linked_ = LinkedCells(std::move(down), std::move(up), loss, numbered_.Blocks());
}

void DiffuseLight::SolveSky() {
  sky_inward_.assign(numbered_.AllCells(), glm::vec2(0.0F));
  for (int part = 0; part < 2; ++part) SolveSkyPart(part);
  numbered_.Spread(&sky_inward_);
  numbered_.Spread(&sky_seen_);
}

void DiffuseLight::SolveSkyPart(int part) {
  std::vector<float> right(numbered_.Count(), 0.0F);
  for (std::size_t n = 0; n < right.size(); ++n) {
    for (int side = 0; side < 6; ++side) {
      const Links& links = linked_.LinksOf(n, side);
      if (links.to[side / 2] != NumberedCells::kNone) continue;
      right[n] += links.conductance[side / 2] * kSkySeen[static_cast<std::size_t>(side)][part];
    }
  }
  std::vector<float> share(right.size(), 0.5F * static_cast<float>(part));
  linked_.Solve(right, kSkyTolerance, &share);
  std::vector<float> own(numbered_.AllCells(), 0.0F);
  for (std::size_t n = 0; n < share.size(); ++n) {
    const std::size_t i = numbered_.CellOf(n);
    const float seen = sky_seen_[i][part];
    sky_inward_[i][part] = (seen - share[n]) / (3.0F * optics_[n].transport_exit + 2.0F);
    sky_seen_[i][part] = (1.0F - walls_.Hidden()[i]) * seen;
    own[i] = sky_seen_[i][part] - 4.0F * sky_inward_[i][part];
  }
  std::vector<float> from_walls(own.size(), 0.0F);
  walls_.FindArriving(own, &from_walls);
  for (std::size_t n = 0; n < numbered_.Count(); ++n) {
    const std::size_t i = numbered_.CellOf(n);
    sky_seen_[i][part] += from_walls[i];
  }
}

// Computes the transmittance of sunlight to each cell, and its mean on the path to the next cell in
// the positive direction of each axis.
void DiffuseLight::FindTransmittances(const std::vector<float>& arrived_root) {
  sun_.resize(numbered_.Count());
  ForShares(sun_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const float root = arrived_root[numbered_.CellOf(n)];
      sun_[n].depth = root * root;
      sun_[n].transmittance = std::exp(-sun_[n].depth);
    }
  });
  ForShares(sun_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      SunAt& here = sun_[n];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int32_t to = linked_.Up(n).to[axis];
        if (to == NumberedCells::kNone) continue;
        const SunAt& there = sun_[static_cast<std::size_t>(to)];
        const float most = std::max(here.transmittance, there.transmittance);
        here.mean_transmittance_up[axis] =
            most < kDarkTransmittance ? 0.0F : MeanTransmittance(most, here.depth, there.depth);
      }
    }
  });
}

// Returns the sunlight that cell number `n` turns into diffuse light.
float DiffuseLight::SunlightScattered(std::size_t n, const glm::dvec3& towards_sun) const {
  const Optics& here = optics_[n];
  const float depth = sun_[n].depth;
  float scattered = 0.0F;
  float mean_transmittance = 0.0F;
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const bool up = side % 2 == 1;
    // Component of the sunlight's direction of travel along this side's outward normal.
    const auto along = (up ? -1.0F : 1.0F) * static_cast<float>(towards_sun[axis]);
    const auto half_m = static_cast<float>(0.5 * cells_.cell_m[axis]);
    const Links& links = linked_.LinksOf(n, side);
    const float slack = slack_[n][static_cast<std::size_t>(side)];
    float flux = 0.0F;
    float transmittance = 0.0F;
    if (links.to[axis] != NumberedCells::kNone) {
      const auto other = static_cast<std::size_t>(links.to[axis]);
      const float between = half_m * (here.light_per_m + optics_[other].light_per_m);
      transmittance = sun_[up ? n : other].mean_transmittance_up[axis];
      if (transmittance == 0.0F) continue;
      flux = along * (3.0F * between + slack) * transmittance;
    } else {
      const float out = half_m * here.light_per_m;
      // The optical depth of sunlight where it passes the cloud's surface at this side.
      const float surface = along < 0.0F ? std::max(depth + out / std::min(along, -1e-3F), 0.0F)
                                         : depth + out / std::max(along, 1e-3F);
      const float surface_transmittance = std::exp(-surface);
      transmittance =
          MeanTransmittance(std::max(sun_[n].transmittance, surface_transmittance), depth, surface);
      flux = along * (3.0F * out * transmittance + slack * surface_transmittance);
    }
    scattered -= links.conductance[axis] * flux;
    mean_transmittance += transmittance / 6.0F;
  }
  return scattered -
         static_cast<float>(cells_.cell_m.z) * here.absorption_per_m * mean_transmittance;
}

void DiffuseLight::BeginFluence(const glm::dvec3& towards_sun) {
  const glm::dvec3 step = towards_sun - last_sun_;
  const bool goes_on = glm::distance(step, last_step_) < 0.5 * glm::length(last_step_);
  if (goes_on) {
    for (std::size_t n = 0; n < fluence_.size(); ++n) {
      const float last = fluence_[n];
      fluence_[n] = 2.0F * last - fluence_before_[n];
      fluence_before_[n] = last;
    }
  } else {
    fluence_before_ = fluence_;
  }
  last_sun_ = towards_sun;
  last_step_ = step;
}

const std::vector<float>& DiffuseLight::SolveSun(const glm::dvec3& towards_sun,
                                                 const std::vector<float>& arrived_root,
                                                 double tolerance) {
  THUNDERHEAD_CHECK(arrived_root.size() == numbered_.AllCells(),
                    std::to_string(arrived_root.size()));
  const std::size_t count = numbered_.Count();
  FindTransmittances(arrived_root);
  std::vector<float> right(count, 0.0F);
  ForShares(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) right[n] = SunlightScattered(n, towards_sun);
  });
  BeginFluence(towards_sun);
  last_iterations_ = linked_.Solve(right, tolerance, &fluence_);
  std::vector<float> inward(count);
  std::vector<float> own(count);
  ForShares(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const float exit = optics_[n].exit;
      const float depth = sun_[n].depth;
      const float lit = physics::glsl::lit_fluence(exit, depth);
      inward[n] = (lit - fluence_[n]) / (3.0F * optics_[n].transport_exit + 2.0F);
      own[n] = 4.0F * ((exit < depth ? exit / depth : 1.0F) - inward[n]);
    }
  });
  numbered_.SetByCell(own, &at_cells_);
  walls_.FindArriving(at_cells_, &from_walls_);
  numbered_.SetByCell(inward, &net_inward_);
  numbered_.Spread(&net_inward_);
  return net_inward_;
}

const std::vector<float>& DiffuseLight::AtCells(const CellValue& value, SunParts::Parts parts) {
  ForShares(values_.size(), [&](std::size_t begin, std::size_t end) {
    if (!parts[begin / kShare % SunParts::kCount]) return;
    for (std::size_t n = begin; n < end; ++n) {
      const glm::ivec3 cell = cells_.CellAt(numbered_.CellOf(n));
      values_[n] = value((glm::dvec3(cell) + 0.5) * cells_.cell_m, outward_[n]);
    }
  });
  numbered_.SetByCell(values_, &at_cells_);
  numbered_.Spread(&at_cells_);
  return at_cells_;
}

}  // namespace thunderhead::renderers
