#include "reference/scene_problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <thread>
#include <utility>
#include <vector>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "glm/vector_relational.hpp"
#include "physics/chunked_work.h"
#include "physics/field_pattern.h"
#include "physics/optics.h"
#include "physics/sky.h"
#include "scene/detailed_medium.h"
#include "scene/drawn_fields.h"
#include "scene/ground.h"
#include "scene/shaded_air.h"
#include "scene/view.h"
#include "volume/terrain.h"

namespace thunderhead::reference {
// The light of the scene's sun and sky, for the scene's solar irradiance.
struct SceneLight {
  SceneLight(const scene::Scene& scene, const glm::vec3& towards_sun, float ground_m)
      : atmosphere(static_cast<float>(scene.sky.turbidity),
                   static_cast<float>(scene.sky.ground_albedo)),
        sky(atmosphere, towards_sun, {ground_m, ground_m}) {
    // Above this height sunlight no longer changes.
    constexpr double kHighestSun_m = 4e4;
    for (int i = 0; i * Surroundings::kSunStep_m <= kHighestSun_m; ++i) {
      const physics::AirPlace place{static_cast<float>(i * Surroundings::kSunStep_m),
                                    towards_sun.z};
      sun_by_height.push_back(scene.sun.irradiance *
                              glm::dvec3(atmosphere.SunTransmittance(place)));
    }
  }

  physics::Atmosphere atmosphere;
  physics::ClearSky sky;                  // seen from the ground, because this sky lights the storm
  std::vector<glm::dvec3> sun_by_height;  // Surroundings::sun_by_height
};

namespace {

struct GridBox {
  volume::RegularGrid grid;
  glm::ivec3 first_cell{0};  // offset of the first cell in the domain
  glm::dvec3 low_m{0.0};
  glm::dvec3 high_m{0.0};
};

// Returns the cells to use and their box. With linear interpolation, the box includes a border of
// empty cells, at whose centres the extinction reaches zero.
GridBox BoxOf(const volume::HydrometeorFields& fields, const MediumOptions& options) {
  const volume::RegularGrid& domain = fields.grid;
  volume::CellBox occupied = fields.condensate;
  if (occupied.Empty()) occupied = {glm::ivec3(0), glm::ivec3(1)};
  if (options.sides == Sides::kPeriodic) {
    occupied.low = glm::ivec3(0, 0, occupied.low.z);
    occupied.high = glm::ivec3(domain.cells.x, domain.cells.y, occupied.high.z);
  }
  const int border = options.interpolation == Interpolation::kLinear ? 1 : 0;
  const glm::ivec3 low = glm::max(occupied.low - border, glm::ivec3(0));
  const glm::ivec3 high = glm::min(occupied.high + border, domain.cells);
  GridBox box;
  box.first_cell = low;
  box.grid = {high - low, domain.spacing_m,
              domain.low_corner_m + glm::dvec3(low) * domain.spacing_m};
  const glm::dvec3 low_border(glm::notEqual(low, occupied.low));
  const glm::dvec3 high_border(glm::notEqual(high, occupied.high));
  box.low_m = box.grid.low_corner_m + 0.5 * low_border * domain.spacing_m;
  box.high_m = box.grid.HighCorner_m() - 0.5 * high_border * domain.spacing_m;
  return box;
}

void AddField(const volume::RegularGrid& domain, const GridBox& box,
              const volume::HydrometeorField& field, const volume::MassExtinction& mass_extinction,
              std::vector<float>* extinction_per_m) {
  const glm::ivec3& cells = box.grid.cells;
  extinction_per_m->resize(box.grid.CellCount(), 0.0F);
  for (int z = 0; z < cells.z; ++z) {
    for (int y = 0; y < cells.y; ++y) {
      volume::AddExtinction(
          field, mass_extinction,
          domain.Offset(box.first_cell.x, box.first_cell.y + y, box.first_cell.z + z),
          static_cast<std::size_t>(cells.x), extinction_per_m->data() + box.grid.Offset(0, y, z));
    }
  }
}

using Values = std::vector<float>;

// Returns for each drawn field the extinction in 1/m, including detail, at the cell centres of
// `grid`.
std::vector<Values> DetailedExtinctions(const scene::Scene& scene,
                                        const volume::HydrometeorFields& fields,
                                        const volume::RegularGrid& grid) {
  const std::size_t count = scene::DrawnFieldsOf(scene, fields).size();
  const auto medium = scene::DetailedMedium::Of(scene, fields);
  std::vector<Values> values(count, Values(grid.CellCount()));
  const int threads = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
  physics::ForEachChunk(grid.cells.z, {.threads = threads}, [&](int z) {
    for (int y = 0; y < grid.cells.y; ++y) {
      for (int x = 0; x < grid.cells.x; ++x) {
        const volume::DrawnMedium::Channels here =
            medium->At_per_m(grid.low_corner_m + (glm::dvec3(x, y, z) + 0.5) * grid.spacing_m);
        for (std::size_t i = 0; i < count; ++i) values[i][grid.Offset(x, y, z)] = here[i];
      }
    }
  });
  return values;
}

void AddScaled(Values values, float factor, Values* sum) {
  for (float& value : values) value *= factor;
  if (sum->empty()) {
    *sum = std::move(values);
  } else {
    std::transform(sum->begin(), sum->end(), values.begin(), sum->begin(), std::plus<>());
  }
}

// The optics that all fields of a group have in common.
struct GroupLook {
  physics::PhaseFunction phase;
  glm::dvec3 albedo{1.0};

  bool operator==(const GroupLook&) const = default;
};

GroupLook LookOf(const scene::DrawnField& field) {
  return {field.phase, static_cast<double>(field.albedo) * glm::dvec3(field.color)};
}

// A group's optics after delta scaling. The group's extinction is multiplied by `extinction`.
struct CutOptics {
  std::shared_ptr<const SampledPhase> phase;
  glm::dvec3 albedo{1.0};
  double extinction = 1.0;
};

CutOptics CutPeak(const GroupLook& look, double peak_cut_deg) {
  if (peak_cut_deg <= 0.0) {
    return {std::make_shared<const SampledPhase>(SampledPhase::Of(look.phase)), look.albedo, 1.0};
  }
  const physics::DeltaScaling cut = physics::CutForwardPeak(look.phase, glm::radians(peak_cut_deg));
  const auto held = [phase = look.phase, cut](int color) {
    return
        [=](double mu) { return physics::PhaseColors(phase, std::min(mu, cut.cut_cosine))[color]; };
  };
  const DeltaScaled scaled = ScaleForward(look.albedo, cut.forward_share);
  CutOptics optics;
  optics.extinction = scaled.extinction;
  optics.albedo = scaled.albedo;
  optics.phase = std::make_shared<const SampledPhase>(
      SampledPhase::Tabulated(std::array<SampledPhase::Function, 3>{held(0), held(1), held(2)}));
  return optics;
}

// Data that the functions of Surroundings have in common.
struct Around {
  Around(const scene::Scene& scene, const glm::vec3& towards_sun, const scene::View& seen_from,
         float ground_m, std::shared_ptr<const SceneLight> of_scene)
      : light(std::move(of_scene)),
        seen_sky(light->atmosphere, glm::vec3(seen_from.local_from_world * glm::dvec3(towards_sun)),
                 {static_cast<float>(seen_from.altitude_m), ground_m}),
        view(seen_from),
        brightness(scene.sky.brightness),
        scale(scene.sun.irradiance * scene.sky.brightness),
        turbidity(static_cast<float>(scene.sky.turbidity)) {}

  // Returns the sky as the eye sees it.
  physics::ClearSky::Seen Seen(const glm::dvec3& direction) const {
    physics::ClearSky::Seen seen = seen_sky.At(glm::vec3(view.local_from_world * direction));
    seen.radiance *= static_cast<float>(scale);
    return seen;
  }

  std::shared_ptr<const SceneLight> light;
  physics::ClearSky seen_sky;  // sky seen from the eye
  scene::View view;
  double brightness;
  double scale;
  float turbidity;
};

// Returns the effect of the air between the eye and an object. The air attenuates the object's
// light and adds a part of the sky's radiance as airlight.
Air AirBefore(const Around& around, const Ray& ray, double distance_m, Behind behind) {
  namespace air = physics::glsl;
  const physics::ClearSky::Seen sky = around.Seen(ray.direction);
  const glm::vec3 sky_depth = air::depth_of_air_mass(around.turbidity, sky.air_mass);
  // The sky's ray already ends at the ground, so all of its air is in front of the ground.
  if (behind == Behind::kGround) return {glm::exp(-sky_depth), sky.radiance};
  const scene::View& view = around.view;
  const double sine = (view.local_from_world * ray.direction).z;
  const auto height_m = static_cast<float>(std::max(view.altitude_m, 0.0));
  const glm::vec3 depth = air::depth_of_air(
      around.turbidity, air::densities_of_air(height_m),
      {height_m, static_cast<float>(sine), static_cast<float>(view.ground_curvature_per_m),
       static_cast<float>(distance_m)});
  const glm::vec3 transmittance = glm::exp(-depth);
  return {glm::dvec3(transmittance),
          glm::dvec3(air::airlight_before(transmittance, sky.radiance, sky_depth))};
}

// Upper limit of the ratio in LightOfAir. In the Earth's shadow the divisor is nearly zero.
constexpr float kMostGathered = 2.0F;

// Returns the light that a metre of lit air at `distance_m` on a ray sends to the eye. This light
// is that metre's part of the airlight of AirBefore. It is divided between sunlight and skylight in
// proportion to how much of each the air scatters. AirBefore distributes the sky's light along the
// ray in proportion to extinction, although haze near the eye contributes more next to the sun.
AirLight LightOfAir(const Around& around, const Ray& ray, double distance_m,
                    const glm::dvec3& towards_sun) {
  namespace air = physics::glsl;
  const scene::View& view = around.view;
  const air::AirPath path{static_cast<float>(std::max(view.altitude_m, 0.0)),
                          static_cast<float>((view.local_from_world * ray.direction).z),
                          static_cast<float>(view.ground_curvature_per_m),
                          static_cast<float>(distance_m)};
  const float height_m = std::max(air::height_on_path_m(path, path.distance_m), 0.0F);
  const glm::vec2 densities = air::densities_of_air(height_m);
  const physics::AirPlace place{height_m, static_cast<float>(towards_sun.z)};
  const auto mu = static_cast<float>(glm::dot(ray.direction, towards_sun));
  const glm::vec3 transmittance =
      glm::exp(-air::depth_of_air(around.turbidity, air::densities_of_air(path.height_m), path));
  const physics::ClearSky::Seen sky = around.Seen(ray.direction);
  const glm::vec3 gathered =
      air::airlight_per_m(transmittance, air::air_extinction_per_m(around.turbidity, densities),
                          sky.radiance, air::depth_of_air_mass(around.turbidity, sky.air_mass));
  const auto scale = static_cast<float>(around.scale);
  const glm::vec3 scattered = air::skylight_scattered_per_m(around.turbidity, densities);
  const glm::vec3 of_sun = scale * air::sunlight_scattered_per_m(around.turbidity, densities, mu) *
                           around.light->atmosphere.SunTransmittance(place);
  const glm::vec3 of_sky = scale * scattered * around.light->atmosphere.DiffuseMeanRadiance(place);
  const glm::vec3 seen = glm::min(gathered / glm::max(of_sun + of_sky, glm::vec3(1e-20F)),
                                  kMostGathered * transmittance);
  // The last value is a factor of the medium's radiance, which already includes the sun's
  // irradiance. Its factor is therefore `brightness` alone instead of `scale`.
  return {glm::dvec3(seen * of_sun), glm::dvec3(seen * of_sky),
          glm::dvec3(seen * static_cast<float>(around.brightness) * scattered)};
}

// Returns the reflectance of the ground where rays from the eye meet it, or null if it is the same
// everywhere. It is evaluated at a point, not averaged over a pixel. Only borders and rings have a
// width that depends on the pixel.
std::function<SeenGround(const glm::dvec2&)> SeenGroundOf(const scene::Scene& scene,
                                                          const volume::HydrometeorFields& fields,
                                                          const scene::View& view) {
  const scene::Ground look = scene::DrawnGround(scene, fields);
  if (look == scene::Ground{}) return nullptr;
  const glm::vec3 plain = scene::PlainReflectance(scene);
  const bool by_land_use = look.cover == scene::GroundCover::kLandUse;
  const float contrast = physics::FieldContrast(by_land_use ? fields.land.mean_reflectance : plain);
  const glm::dvec2 middle_m = scene::RingMiddle_m(fields);
  const glm::vec2 north(scene::TrueNorth(fields));
  const double height_px = scene.output.height_px;
  const double ground_m = volume::LowestTerrain_m(fields);
  return [=, land = by_land_use ? fields.land : volume::LandSurface{},
          borders = look.borders && !fields.borders->nearest.empty() ? fields.borders : nullptr,
          grid = fields.grid](const glm::dvec2& place_m) {
    const auto& pattern = physics::FieldPattern::Plains();
    const glm::vec2 place(place_m);
    const glm::vec2 point(0.0F);
    SeenGround seen;
    if (by_land_use) {
      const volume::LandSample sample = volume::LandAt(land, grid, place_m);
      seen.albedo = glm::dvec3(sample.reflectance * pattern.Grain(place, point, contrast));
      seen.water = sample.water;
    } else if (look.cover == scene::GroundCover::kFields) {
      seen.albedo = glm::dvec3(plain * pattern.Reflectance(place, point, contrast));
    } else {
      seen.albedo = glm::dvec3(plain);
    }
    const double distance_m = glm::distance(view.eye_m, glm::dvec3(place_m, ground_m));
    const auto across_m = static_cast<float>(
        2.0 * (view.half_height_m + view.tan_half_height * distance_m) / height_px);
    const auto paint = [&](const glm::vec3& reflectance, double share) {
      seen.albedo = glm::mix(seen.albedo, glm::dvec3(reflectance), share);
      seen.water *= 1.0 - share;
    };
    if (borders != nullptr) {
      paint(
          physics::glsl::border_reflectance(),
          physics::glsl::border_paint(volume::NearestBorder(*borders, place_m),
                                      static_cast<float>(borders->grid.texel_m), point, across_m));
    }
    if (look.rings) {
      paint(physics::glsl::ring_reflectance(),
            physics::glsl::ring_paint(glm::vec2(place_m - middle_m), north, point, across_m));
    }
    return seen;
  };
}

}  // namespace

std::size_t MediumBytes(const volume::HydrometeorFields& fields, bool similar) {
  constexpr std::size_t kOfField = sizeof(float);
  // Bytes for the sum of the fields' extinctions and for an upper bound of the sum.
  constexpr std::size_t kOfAll = 2 * sizeof(float);
  return fields.grid.CellCount() * (kOfField * fields.fields.size() + (similar ? 2 : 1) * kOfAll);
}

absl::StatusOr<std::shared_ptr<const Medium>> MediumOf(const scene::Scene& scene,
                                                       const volume::HydrometeorFields& fields,
                                                       Sides sides) {
  MediumOptions options;
  options.sides = sides;
  return MediumOf(scene, fields, options);
}

absl::StatusOr<std::shared_ptr<const Medium>> MediumOf(const scene::Scene& scene,
                                                       const volume::HydrometeorFields& fields,
                                                       const MediumOptions& options) {
  const GridBox box = BoxOf(fields, options);
  MediumDescription description;
  description.grid = box.grid;
  description.low_m = box.low_m;
  description.high_m = box.high_m;
  description.interpolation = options.interpolation;
  description.sides = options.sides;
  description.similar = options.similar;
  const int finer = options.detail_voxels_per_cell;
  std::vector<Values> detailed;
  if (finer > 0) {
    if (options.sides != Sides::kOpen || options.interpolation != Interpolation::kLinear) {
      return absl::InvalidArgumentError(
          "turbulent detail needs open sides and linear interpolation between cells");
    }
    description.grid.cells *= finer;
    description.grid.spacing_m /= finer;
    detailed = DetailedExtinctions(scene, fields, description.grid);
  }
  std::vector<GroupLook> looks;
  std::vector<CutOptics> cuts;  // the optics after delta scaling, for each group
  std::size_t drawn = 0;
  for (const scene::DrawnField& field : scene::DrawnFieldsOf(scene, fields)) {
    GroupLook look = LookOf(field);
    if (options.phase != nullptr) look.phase = {};
    auto found = std::find(looks.begin(), looks.end(), look);
    if (found == looks.end()) {
      found = looks.insert(found, look);
      cuts.push_back(options.phase != nullptr ? CutOptics{options.phase, look.albedo, 1.0}
                                              : CutPeak(look, options.peak_cut_deg));
      description.groups.push_back({{}, cuts.back().albedo, cuts.back().phase});
    }
    const auto group = static_cast<std::size_t>(found - looks.begin());
    if (finer > 0) {
      AddScaled(std::move(detailed[drawn++]), static_cast<float>(cuts[group].extinction),
                &description.groups[group].extinction_per_m);
      continue;
    }
    volume::MassExtinction mass_extinction = field.mass_extinction;
    mass_extinction.m2_per_kg *= static_cast<float>(cuts[group].extinction);
    AddField(fields.grid, box, fields.fields[field.index], mass_extinction,
             &description.groups[group].extinction_per_m);
  }
  return Medium::Create(std::move(description));
}

std::shared_ptr<const SceneLight> LightOf(const scene::Scene& asked,
                                          const volume::HydrometeorFields& fields) {
  const scene::Scene scene = scene::WithGroundOf(asked, fields);
  return std::make_shared<const SceneLight>(
      scene, glm::vec3(scene::Direction(scene.sun.azimuth_deg, scene.sun.elevation_deg)),
      static_cast<float>(volume::LowestTerrain_m(fields)));
}

Surroundings SurroundingsOf(const scene::Scene& asked, const volume::HydrometeorFields& fields,
                            GroundLight ground_light, std::shared_ptr<const SceneLight> light) {
  if (light == nullptr) light = LightOf(asked, fields);
  const scene::Scene scene = scene::WithGroundOf(asked, fields);
  Surroundings around;
  around.towards_sun = scene::Direction(scene.sun.azimuth_deg, scene.sun.elevation_deg);
  const glm::vec3 towards_sun(around.towards_sun);
  const scene::View view = scene::ViewOf(scene, fields);
  const double lowest_m = volume::LowestTerrain_m(fields);
  const auto shared = std::make_shared<const Around>(
      scene, towards_sun, view, static_cast<float>(lowest_m), std::move(light));
  around.sun_irradiance = scene.sun.irradiance * glm::dvec3(shared->light->sky.SunTransmittance());
  around.sun_by_height = shared->light->sun_by_height;
  const physics::AirPlace eye{static_cast<float>(std::max(view.altitude_m, 0.0)),
                              static_cast<float>((view.local_from_world * around.towards_sun).z)};
  const double solid_angle = 2.0 * std::numbers::pi * (1.0 - std::cos(physics::kSunRadius_rad));
  around.disc = SunDisc{std::cos(physics::kSunRadius_rad),
                        scene.sun.irradiance / solid_angle *
                            glm::dvec3(shared->light->atmosphere.SunTransmittance(eye))};
  for (const scene::DirectionalLight& lamp : scene.lights) {
    around.lights.push_back(
        {scene::Direction(lamp.azimuth_deg, lamp.elevation_deg), lamp.irradiance * lamp.color});
  }
  around.sky = [shared](const glm::dvec3& direction) {
    return shared->scale * glm::dvec3(shared->light->sky.At(glm::vec3(direction)).radiance);
  };
  around.seen_sky = [shared](const glm::dvec3& direction) {
    return glm::dvec3(shared->Seen(direction).radiance);
  };
  Ground ground;
  ground.height_m = lowest_m;
  ground.touch_m = view.touch_m;
  ground.curvature_per_m = view.ground_curvature_per_m;
  const glm::dvec3 albedo(scene::PlainReflectance(scene));
  if (ground_light == GroundLight::kShaded) {
    ground.albedo = albedo;
    ground.seen = SeenGroundOf(scene, fields, view);
  } else {
    const glm::dvec3 direct = around.sun_irradiance * std::max(around.towards_sun.z, 0.0);
    const glm::dvec3 diffuse = shared->scale * glm::dvec3(shared->light->sky.Light().irradiance);
    ground.radiance = albedo * (direct + diffuse) * std::numbers::inv_pi;
  }
  around.ground = ground;
  around.air = [shared](const Ray& ray, double distance_m, Behind behind) {
    return AirBefore(*shared, ray, distance_m, behind);
  };
  const GridBox storm = BoxOf(fields, MediumOptions{});
  if (around.towards_sun.z > 0.0 && !fields.condensate.Empty()) {
    const scene::ShadedAir shaded =
        scene::ShadedAirOf({storm.low_m, storm.high_m}, around.towards_sun, lowest_m);
    around.shaded_air =
        ShadedAir{{{shaded.from_sun.low_m, shaded.from_sun.high_m},
                   {shaded.from_sky.low_m, shaded.from_sky.high_m}},
                  [shared, towards_sun = around.towards_sun](const Ray& ray, double distance_m) {
                    return LightOfAir(*shared, ray, distance_m, towards_sun);
                  }};
  }
  return around;
}

Camera CameraOf(const scene::Scene& scene, const volume::HydrometeorFields& fields) {
  return Camera::Of(scene::ViewOf(scene, fields));
}

}  // namespace thunderhead::reference
