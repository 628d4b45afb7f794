#include "scene/storm_ray.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glm/common.hpp"
#include "scene/drawn_fields.h"
#include "scene/ground_hit.h"

namespace thunderhead::scene {
namespace {

// Returns the part of the ray that lies in the domain and in the box around the condensate. Outside
// this box all interpolated values are 0.
Span NearCondensate(const volume::HydrometeorFields& fields, const glm::dvec3& origin_m,
                    const glm::dvec3& direction, const Span& in_domain) {
  const volume::RegularGrid& grid = fields.grid;
  if (fields.condensate.Empty() || in_domain.end_m <= in_domain.begin_m) return {};
  const glm::ivec3 low = glm::max(fields.condensate.low - 1, 0);
  const glm::ivec3 high = glm::min(fields.condensate.high + 1, grid.cells);
  return SpanWithin(grid.low_corner_m + glm::dvec3(low) * grid.spacing_m,
                    grid.low_corner_m + glm::dvec3(high) * grid.spacing_m, origin_m, direction,
                    in_domain.end_m);
}

}  // namespace

StormRay::StormRay(const Scene& scene, const volume::HydrometeorFields& fields,
                   const glm::dvec3& origin_m, const glm::dvec3& direction)
    : origin_m_(origin_m),
      direction_(direction),
      ground_m_(Surface(scene, fields).MeetsRay_m(origin_m, direction, kFarthestGround_m)),
      in_domain_(SpanWithin(fields.grid.low_corner_m, fields.grid.HighCorner_m(), origin_m,
                            direction,
                            ground_m_.value_or(std::numeric_limits<double>::infinity()))),
      pieces_(PiecesOf(fields.grid, origin_m, direction,
                       NearCondensate(fields, origin_m, direction, in_domain_))) {
  const std::vector<DrawnField> drawn = DrawnFieldsOf(scene, fields);
  steps_.reserve(pieces_.size());
  for (const RayPiece& piece : pieces_) {
    CornerValues extinctions_per_m{};
    for (std::size_t i = 0; i < extinctions_per_m.size(); ++i) {
      float sum_per_m = 0.0F;
      for (const DrawnField& field : drawn) {
        volume::AddExtinction(fields.fields[field.index], field.mass_extinction,
                              piece.corners.cells[i], 1, &sum_per_m);
      }
      extinctions_per_m[i] = sum_per_m;
    }
    steps_.push_back({piece.Of(extinctions_per_m), depth_});
    depth_ += piece.Length_m() * steps_.back().extinction_per_m.Integral(1.0);
  }
}

std::optional<double> StormRay::WhereDepthIs_m(double depth) const {
  if (depth > depth_) return std::nullopt;
  const auto after = std::ranges::lower_bound(steps_, depth, {}, &Step::depth_before);
  if (after == steps_.begin()) return std::nullopt;
  const auto at = static_cast<std::size_t>(after - steps_.begin()) - 1;
  const RayPiece& piece = pieces_[at];
  return piece.Along_m(steps_[at].extinction_per_m.WhereIntegralIs(
      (depth - steps_[at].depth_before) / piece.Length_m()));
}

Seen StormRay::WhatIsSeen() const {
  if (depth_ >= kThinnestSeen_depth) return Seen::kCloud;
  return ground_m_.has_value() ? Seen::kGround : Seen::kSky;
}

std::optional<double> StormRay::WhereSeen_m() const {
  if (WhatIsSeen() != Seen::kCloud) return ground_m_;
  return WhereDepthIs_m(-std::log(1.0 - 0.5 * (1.0 - std::exp(-depth_))));
}

}  // namespace thunderhead::scene
