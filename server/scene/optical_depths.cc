#include "scene/optical_depths.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "scene/detailed_medium.h"
#include "scene/ground_hit.h"
#include "scene/ray_span.h"
#include "scene/view.h"

namespace thunderhead::scene {
namespace {

struct Depths {
  float depth = 0.0F;
  float one_m = std::numeric_limits<float>::infinity();
};

class DepthRays {
 public:
  DepthRays(const Scene& scene, const volume::HydrometeorFields& fields)
      : medium_(DetailedMedium::Of(scene, fields, FieldLookOf(scene.rendering.technique).detail)),
        surface_(scene, fields),
        view_(ViewOf(scene, fields)),
        steps_per_half_cell_(FieldLookOf(scene.rendering.technique).detail ? kDetailSteps : 1.0) {}

  // Returns the optical depth and the depth-one distance along the ray through normalised device
  // coordinates.
  Depths Through(double x, double y) const {
    const auto [origin_m, direction] = RayThrough(view_, x, y);
    const volume::ExtinctionVolume& volume = medium_->Volume();
    if (volume.Empty()) return {};
    Span span = SpanWithin(volume.low_m, volume.high_m, origin_m, direction,
                           std::numeric_limits<double>::infinity());
    if (span.end_m <= span.begin_m) return {};
    if (const auto ground_m = surface_.MeetsRay_m(origin_m, direction, span.end_m)) {
      span.end_m = std::min(span.end_m, *ground_m);
    }
    const double length_m = span.end_m - span.begin_m;
    if (length_m <= 0.0) return {};
    const double step_m = HalfCell_m(volume.grid, direction) / steps_per_half_cell_;
    const auto steps = static_cast<int>(std::ceil(length_m / step_m));
    return March(origin_m, direction, span.begin_m, length_m / steps, steps);
  }

 private:
  // Integration steps in each half cell if the medium has detail. With the default number of
  // octaves and the default wavelength, the wavelength of the finest octave is 3/8 of a cell,
  // or 1.5 steps.
  static constexpr double kDetailSteps = 2.0;

  // Integrates the extinction by the midpoint rule with equal steps.
  Depths March(const glm::dvec3& origin_m, const glm::dvec3& direction, double begin_m,
               double step_m, int steps) const {
    double depth = 0.0;
    Depths depths;
    for (int i = 0; i < steps; ++i) {
      const double before_m = begin_m + i * step_m;
      double extinction_per_m = 0.0;
      for (const float field_per_m :
           medium_->At_per_m(origin_m + (before_m + 0.5 * step_m) * direction)) {
        extinction_per_m += field_per_m;
      }
      const double after = depth + step_m * extinction_per_m;
      if (depth < 1.0 && after >= 1.0) {
        depths.one_m = static_cast<float>(before_m + (1.0 - depth) / extinction_per_m);
      }
      depth = after;
    }
    depths.depth = static_cast<float>(depth);
    return depths;
  }

  const std::shared_ptr<const DetailedMedium> medium_;
  const Surface surface_;
  const View view_;
  const double steps_per_half_cell_;
};

}  // namespace

void AddOpticalDepths(const Scene& scene, const volume::HydrometeorFields& fields,
                      picture::LinearPicture* picture) {
  const DepthRays rays(scene, fields);
  const glm::ivec2 size_px = picture->size_px;
  const auto width = static_cast<std::size_t>(size_px.x);
  picture->optical_depth.resize(width * static_cast<std::size_t>(size_px.y));
  picture->depth_one_distance_m.resize(picture->optical_depth.size());
  tbb::parallel_for(0, size_px.y, [&](int row) {
    const double y = 1.0 - (row + 0.5) * 2.0 / size_px.y;
    for (int column = 0; column < size_px.x; ++column) {
      const Depths depths = rays.Through((column + 0.5) * 2.0 / size_px.x - 1.0, y);
      const std::size_t at =
          static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column);
      picture->optical_depth[at] = depths.depth;
      picture->depth_one_distance_m[at] = depths.one_m;
    }
  });
}

}  // namespace thunderhead::scene
