#include "renderers/cumulus/surface_of_scene.h"

#include <algorithm>

#include "base/status.h"
#include "clouds/cauliflower.h"
#include "clouds/inscribed_balls.h"
#include "glm/common.hpp"
#include "scene/drawn_fields.h"
#include "volume/coarsen.h"

namespace thunderhead::renderers {
namespace {

// Maximum number of cells for the surface. Larger grids are coarsened first, because the surface is
// no finer than its ellipsoids.
constexpr std::size_t kMaxSurfaceCells = 4'000'000;
constexpr int kMaxSurfaceBalls = 700;

// Returns true for cloud water and ice. Precipitation has no surface.
bool HasSurface(physics::Hydrometeor hydrometeor) {
  return hydrometeor == physics::Hydrometeor::kCloud || hydrometeor == physics::Hydrometeor::kIce;
}

// Returns the smallest factor that leaves at most kMaxSurfaceCells cells if the grid is coarsened
// by it along each axis.
int CoarseningOf(const volume::RegularGrid& grid) {
  int factor = 1;
  while (grid.CellCount() / static_cast<std::size_t>(factor * factor * factor) > kMaxSurfaceCells) {
    ++factor;
  }
  return factor;
}

const scene::Cumulus& CumulusOf(const scene::Scene& scene) {
  return std::get<scene::Cumulus>(scene.rendering.technique);
}

DrawnSurface SurfaceOfStorm(const scene::Scene& scene, const volume::HydrometeorFields& fields) {
  DrawnSurface drawn;
  std::vector<float> extinction_per_m(fields.grid.CellCount(), 0.0F);
  for (const scene::DrawnField& field : scene::DrawnFieldsOf(scene, fields)) {
    if (!HasSurface(field.hydrometeor)) continue;
    volume::AddExtinction(fields.fields[field.index], field.mass_extinction, 0,
                          extinction_per_m.size(), extinction_per_m.data());
    drawn.fields.push_back(field.hydrometeor);
  }
  clouds::InscribedBallsOptions options;
  options.level = CumulusOf(scene).least_extinction_per_m;
  options.max_balls = kMaxSurfaceBalls;
  drawn.surface = clouds::InscribedBalls(fields.grid, extinction_per_m, options);
  std::size_t first = 0;
  for (int scale = 1; scale < CumulusOf(scene).scales; ++scale) {
    const std::size_t end = drawn.surface.bubbles.size();
    clouds::Sprouting sprouting;
    sprouting.seed = CumulusOf(scene).seed;
    sprouting.min_radius_m = drawn.surface.finest_m;
    clouds::Sprout(sprouting, first, &drawn.surface);
    first = end;
  }
  return drawn;
}

// Returns the box of the storm's condensate, or the domain if the storm has no condensate.
clouds::SurfaceBox PlaceOf(const volume::HydrometeorFields& fields) {
  const volume::RegularGrid& grid = fields.grid;
  const volume::CellBox cells =
      fields.condensate.Empty() ? volume::CellBox{glm::ivec3(0), grid.cells} : fields.condensate;
  return {grid.low_corner_m + glm::dvec3(cells.low) * grid.spacing_m,
          grid.low_corner_m + glm::dvec3(cells.high) * grid.spacing_m};
}

absl::StatusOr<clouds::CumulusSurface> SurfaceFromSeed(const scene::Cumulus& cumulus) {
  const clouds::CauliflowerOptions options{cumulus.seed, cumulus.scales};
  switch (cumulus.source) {
    case scene::CumulusSource::kStorm:
    case scene::CumulusSource::kCauliflower:
      return clouds::Cauliflower(options);
    case scene::CumulusSource::kFairWeatherCumulus:
      return clouds::SurfaceOfPreset("fair-weather-cumulus", options);
    case scene::CumulusSource::kCongestus:
      return clouds::SurfaceOfPreset("congestus", options);
    case scene::CumulusSource::kCumulusField:
      return clouds::SurfaceOfPreset("cumulus-field", options);
    case scene::CumulusSource::kEllipsoid:
      return clouds::LoneEllipsoid(options);
  }
  return absl::InternalError("unknown source of a cumulus");
}

}  // namespace

absl::StatusOr<DrawnSurface> SurfaceOf(const scene::Scene& scene,
                                       const volume::HydrometeorFields& fields) {
  if (CumulusOf(scene).source == scene::CumulusSource::kStorm) {
    const int factor = CoarseningOf(fields.grid);
    if (factor == 1) return SurfaceOfStorm(scene, fields);
    return SurfaceOfStorm(scene, volume::Coarsened(fields, glm::ivec3(factor)));
  }
  DrawnSurface drawn;
  THUNDERHEAD_ASSIGN_OR_RETURN(drawn.surface, SurfaceFromSeed(CumulusOf(scene)));
  clouds::FitInto(PlaceOf(fields), &drawn.surface);
  return drawn;
}

std::vector<scene::NotShown> NotShownByCumulus(const scene::Scene& scene,
                                               const volume::HydrometeorFields& fields) {
  using Code = scene::NotShown::Code;
  if (CumulusOf(scene).source != scene::CumulusSource::kStorm) {
    return {{Code::kStorm, "the storm (a cloud generated from a seed is shown instead)"}};
  }
  std::vector<scene::NotShown> not_shown;
  for (const volume::HydrometeorField& field : fields.fields) {
    if (scene::IsDrawn(scene, field) && !HasSurface(field.hydrometeor)) {
      not_shown.push_back({Code::kFields, std::string(physics::NameOf(field.hydrometeor))});
    }
  }
  not_shown.push_back({Code::kFineStructure,
                       "structure inside the surface, and cloud with less extinction than the "
                       "surface's threshold"});
  return not_shown;
}

}  // namespace thunderhead::renderers
