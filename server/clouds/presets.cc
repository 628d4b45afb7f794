#include "clouds/presets.h"

#include <algorithm>
#include <array>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "clouds/repeatable_math.h"
#include "physics/counter_random.h"

namespace thunderhead::clouds {
namespace {

using physics::CounterRandom;

double Between(CounterRandom* random, double low, double high) {
  return low + (high - low) * random->Next();
}

// Returns a grid that is horizontally centred on the origin and begins at sea level.
volume::RegularGrid GridOf(const glm::ivec3& cells, double spacing_m) {
  volume::RegularGrid grid;
  grid.cells = cells;
  grid.spacing_m = glm::dvec3(spacing_m);
  grid.low_corner_m = {-0.5 * cells.x * spacing_m, -0.5 * cells.y * spacing_m, 0.0};
  return grid;
}

// The parameters of one heap of bubbles on a flat base, with wide bubbles below and turrets above.
struct Heap {
  glm::dvec2 middle_m{0.0};
  double base_m = 1000.0;
  double radius_m = 500.0;
  double height_m = 500.0;
  int bubbles = 12;
};

void AddHeap(const Heap& heap, CounterRandom* random, std::vector<Ellipsoid>* ellipsoids) {
  // The body ellipsoid reaches below the base height, where the cloud is cut off flat.
  ellipsoids->push_back({{heap.middle_m.x, heap.middle_m.y, heap.base_m + 0.1 * heap.height_m},
                         {heap.radius_m, 0.85 * heap.radius_m, 0.55 * heap.height_m},
                         {0.0, 0.0, Between(random, 0.0, 180.0)}});
  for (int i = 0; i < heap.bubbles; ++i) {
    const double rise = (i + random->Next()) / heap.bubbles;
    const double azimuth_deg = Between(random, 0.0, 360.0);
    // Higher bubbles are smaller and closer to the middle.
    const double away_m = heap.radius_m * (0.75 - 0.6 * rise) * Between(random, 0.3, 1.0);
    const double radius_m = heap.radius_m * (0.62 - 0.27 * rise) * Between(random, 0.8, 1.15);
    const double z_m = heap.base_m + heap.height_m * (0.15 + 0.65 * rise);
    const double flat = Between(random, 0.75, 1.05);
    ellipsoids->push_back(
        {{heap.middle_m.x + away_m * CosineOfDegrees(azimuth_deg),
          heap.middle_m.y + away_m * SineOfDegrees(azimuth_deg), z_m},
         {radius_m, radius_m * Between(random, 0.8, 1.2), radius_m * flat},
         {Between(random, -15.0, 15.0), Between(random, -15.0, 15.0), azimuth_deg}});
  }
}

CloudShape FairWeatherCumulus(std::uint64_t seed) {
  CloudShape shape;
  shape.grid = GridOf({128, 128, 88}, 20.0);
  shape.noise = {5, 0.65, NoiseInterpolation::kCosine, seed};
  shape.feature_m = 200.0;
  shape.threshold = 0.08;
  shape.water_kg_per_m3 = 2e-3;
  shape.base_m = 800.0;
  CounterRandom random(seed, 1);
  AddHeap({{0.0, 0.0}, 800.0, 800.0, 800.0, 14}, &random, &shape.ellipsoids);
  return shape;
}

CloudShape Congestus(std::uint64_t seed) {
  CloudShape shape;
  shape.grid = GridOf({128, 128, 144}, 40.0);
  shape.noise = {5, 0.65, NoiseInterpolation::kCosine, seed};
  shape.feature_m = 420.0;
  shape.threshold = 0.06;
  shape.water_kg_per_m3 = 5e-3;
  shape.base_m = 900.0;
  CounterRandom random(seed, 2);
  AddHeap({{0.0, 0.0}, 900.0, 1800.0, 2000.0, 18}, &random, &shape.ellipsoids);
  AddHeap({{200.0, -100.0}, 900.0, 1300.0, 4400.0, 30}, &random, &shape.ellipsoids);
  AddHeap({{-800.0, 500.0}, 900.0, 900.0, 2900.0, 16}, &random, &shape.ellipsoids);
  return shape;
}

CloudShape CumulusField(std::uint64_t seed) {
  CloudShape shape;
  constexpr double kHalfWidth_m = 5200.0;
  shape.grid = GridOf({256, 256, 48}, 50.0);
  shape.noise = {4, 0.6, NoiseInterpolation::kCosine, seed};
  shape.feature_m = 320.0;
  shape.threshold = 0.06;
  shape.water_kg_per_m3 = 2e-3;
  shape.base_m = 900.0;
  CounterRandom random(seed, 3);
  for (int i = 0; i < 60; ++i) {
    Heap heap;
    // The third power of a uniform random number gives many small clouds and few large ones.
    const double size = random.Next();
    heap.radius_m = 220.0 + 700.0 * size * size * size;
    heap.height_m = heap.radius_m * Between(&random, 0.8, 1.3);
    heap.middle_m = {Between(&random, -kHalfWidth_m, kHalfWidth_m),
                     Between(&random, -kHalfWidth_m, kHalfWidth_m)};
    heap.base_m = 900.0;
    heap.bubbles = 5 + static_cast<int>(8.0 * size);
    AddHeap(heap, &random, &shape.ellipsoids);
  }
  return shape;
}

struct Preset {
  std::string_view name;
  CloudShape (*make)(std::uint64_t seed);
};

constexpr std::array kPresets = {Preset{"congestus", Congestus},
                                 Preset{"cumulus-field", CumulusField},
                                 Preset{"fair-weather-cumulus", FairWeatherCumulus}};

}  // namespace

std::vector<std::string> PresetNames() {
  std::vector<std::string> names;
  names.reserve(kPresets.size());
  for (const Preset& preset : kPresets) names.emplace_back(preset.name);
  return names;
}

absl::StatusOr<CloudShape> PresetNamed(std::string_view name, std::uint64_t seed) {
  const auto at = std::ranges::find(kPresets, name, &Preset::name);
  if (at != kPresets.end()) return at->make(seed);
  return absl::InvalidArgumentError(absl::StrCat("there is no preset '", std::string(name),
                                                 "'; the presets are ",
                                                 absl::StrJoin(PresetNames(), ", ")));
}

}  // namespace thunderhead::clouds
