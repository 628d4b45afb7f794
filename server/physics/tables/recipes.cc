#include "physics/tables/recipes.h"

#include <array>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/status.h"
#include "physics/refractive_index.h"
#include "physics/tables/sun_disc.h"

namespace thunderhead::physics {
namespace {

// Returns an angle grid for cloud droplets. It is fine in the forward direction (diffraction), in
// the backward direction (glory) and between 125 and 150 degrees (cloudbow).
std::vector<GridSpan> CloudGrid() {
  return {{2, 0.05}, {6, 0.1},    {10, 0.25}, {30, 0.5},
          {125, 1},  {150, 0.25}, {172, 0.5}, {180, 0.1}};
}

std::vector<GridSpan> RainGrid() {
  return {{0.2, 0.01}, {2, 0.05},  {10, 0.25}, {30, 0.5},
          {120, 1},    {145, 0.1}, {178, 0.5}, {180, 0.1}};
}

// Returns an angle grid for ice, which is fine around the halos at 22 and 46 degrees.
std::vector<GridSpan> IceGrid() {
  return {{2, 0.05}, {6, 0.1}, {50, 0.25}, {60, 0.5}, {176, 1}, {180, 0.5}};
}

// Wavelengths of equal weight that represent the band of a colour channel, relative to the band's
// middle. The bands of the three channels together cover sunlight from 0.4 to 0.7 um.
constexpr std::array kBandShiftsUm = {-0.1 / 3.0, 0.0, 0.1 / 3.0};

PhaseTable TableOf(const std::string& name, const std::vector<double>& angles_deg,
                   const std::vector<PhaseRgb>& values) {
  absl::StatusOr<PhaseTable> table = PhaseTable::Create(
      {.name = name, .wavelengths_um = kWavelengthsUm, .angles_deg = angles_deg, .values = values},
      1e-9);
  THUNDERHEAD_CHECK(table.ok(), std::string(table.status().message()));
  return UnderSunDisc(*table);
}

}  // namespace

std::vector<DropletRecipe> DropletRecipes() {
  std::vector<DropletRecipe> recipes;
  for (const int radius_um : {5, 10, 20}) {
    recipes.push_back({.name = absl::StrFormat("cloud_re%02d", radius_um),
                       .sizes = {static_cast<double>(radius_um), 0.1},
                       .grid = CloudGrid(),
                       .radii = 4000,
                       .points = 3});
  }
  recipes.push_back({.name = "cloud_re05_narrow",
                     .sizes = {5.0, 0.01},
                     .grid = CloudGrid(),
                     .radii = 4000,
                     .points = 3});
  recipes.push_back(
      {.name = "rain", .sizes = {500.0, 0.1}, .grid = RainGrid(), .radii = 800, .points = 4});
  return recipes;
}

std::vector<IceRecipe> IceRecipes() {
  const IceCrystal column{.width_um = 50, .length_um = 80};
  const IceCrystal plate{.width_um = 100, .length_um = 40};
  const IceCrystal rough{.width_um = 80, .length_um = 120, .roughness = 0.5};
  std::vector<IceRecipe> recipes;
  for (const auto& [name, crystal] :
       {std::pair{"ice_columns", column}, {"ice_plates", plate}, {"ice_rough", rough}}) {
    recipes.push_back({.name = name,
                       .crystal = crystal,
                       .grid = IceGrid(),
                       .rays = 4'000'000,
                       .orientations = 30'000,
                       .seed = 1});
  }
  return recipes;
}

BuiltTable Build(const DropletRecipe& recipe, const WorkPlan& plan) {
  const std::vector<double> angles_deg = AngleGrid(recipe.grid);
  PhaseAccumulator light(angles_deg);
  for (const double shift_um : kBandShiftsUm) {
    light.Add(
        ScatterByDroplets(recipe.sizes, angles_deg, recipe.radii, recipe.points, plan, shift_um),
        {1.0, 1.0, 1.0});
  }
  PhaseRgb index{};
  for (std::size_t c = 0; c < kPhaseChannels; ++c)
    index[c] = WaterRefractiveIndex(kWavelengthsUm[c]);
  const std::string provenance = absl::StrFormat(
      "Mie theory; water drops, gamma distribution of effective radius %g um and effective "
      "variance "
      "%g\n(%d radii); refractive index %.4f, %.4f, %.4f. Bands of 0.1 um, under the sun's disc.\n"
      "See docs/phase_tables.md.",
      recipe.sizes.effective_radius_um, recipe.sizes.effective_variance, recipe.radii, index[0],
      index[1], index[2]);
  return {TableOf(recipe.name, angles_deg, light.Values()), provenance};
}

BuiltTable Build(const IceRecipe& recipe, const WorkPlan& plan) {
  const std::vector<double> angles_deg = AngleGrid(recipe.grid);
  const RayScattering rays = TraceRays(recipe.crystal, angles_deg, recipe.rays, recipe.seed, plan);
  const PhaseAccumulator diffraction =
      Diffract(recipe.crystal, angles_deg, recipe.orientations, recipe.seed, plan);
  const std::string provenance = absl::StrFormat(
      "Geometric optics and diffraction; randomly oriented hexagonal ice, width %g um, length %g "
      "um,\nroughness %g; refractive index %.4f, %.4f, %.4f; %d rays, seed %d. Of the rays' "
      "energy\n"
      "%.4f went straight on and is spread as diffraction; %.1e was left inside and is dropped.\n"
      "Under the sun's disc. See docs/phase_tables.md.",
      recipe.crystal.width_um, recipe.crystal.length_um, recipe.crystal.roughness,
      kIceRefractiveIndex[0], kIceRefractiveIndex[1], kIceRefractiveIndex[2], recipe.rays,
      recipe.seed, rays.budget.straight[1], rays.budget.left[1]);
  return {TableOf(recipe.name, angles_deg, PhaseOf(rays, diffraction, angles_deg)), provenance};
}

}  // namespace thunderhead::physics
