// Tests of rays through fields of known form, against closed forms and many small steps.
#include "scene/ray_probe.h"

#include <cmath>
#include <random>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "scene/drawn_fields.h"
#include "scene/view.h"

namespace thunderhead::scene {
namespace {

using ::testing::Each;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kExtinction_per_m = 0.001;

// A storm of 20 x 16 columns of 500 m and 10 levels of 250 m, over flat ground at 0 m, seen by a
// camera of a flat world.
struct Storm {
  Storm() {
    fields.grid = {{20, 16, 10}, {500.0, 500.0, 250.0}, {-5000.0, -4000.0, 0.0}};
    fields.condensate = {{0, 0, 0}, fields.grid.cells};
    fields.terrain_height_m.assign(320, 0.0F);
    scene.camera = TopDownCamera();
  }

  // Adds a field with this extinction everywhere.
  volume::HydrometeorField& Add(physics::Hydrometeor hydrometeor, double extinction_per_m) {
    volume::HydrometeorField field;
    field.hydrometeor = hydrometeor;
    field.quantity = volume::Quantity::kExtinction;
    field.concentration_kg_per_m3.assign(fields.grid.CellCount(),
                                         static_cast<float>(extinction_per_m));
    return fields.fields.emplace_back(field);
  }

  StormRay Ray(const glm::dvec3& origin_m, const glm::dvec3& direction) const {
    return {scene, fields, origin_m, glm::normalize(direction)};
  }
  RayProbe Probe(const glm::dvec3& origin_m, const glm::dvec3& direction, int samples = 0) const {
    return ProbeRay(scene, fields, Ray(origin_m, direction), {samples, 0.1});
  }

  volume::HydrometeorFields fields;
  Scene scene;
};

TEST(RayProbeTest, UniformFieldsDepthIsExtinctionTimesLength) {
  Storm storm;
  storm.Add(physics::Hydrometeor::kCloud, kExtinction_per_m);
  const auto extinction = static_cast<double>(static_cast<float>(kExtinction_per_m));
  // The ray passes the whole domain along x, up to its faces.
  const StormRay level = storm.Ray({-50000.0, 130.0, 1234.0}, {1.0, 0.0, 0.0});
  EXPECT_NEAR(level.OpticalDepth(), extinction * 10000.0, 1e-9);
  EXPECT_NEAR(level.InDomain().begin_m, 45000.0, 1e-9);
  EXPECT_NEAR(*level.WhereDepthIs_m(1.0), 45000.0 + 1.0 / extinction, 1e-6);
  EXPECT_NEAR(*level.WhereDepthIs_m(0.1), 45000.0 + 0.1 / extinction, 1e-6);
  EXPECT_FALSE(level.WhereDepthIs_m(10.1).has_value());
  EXPECT_FALSE(level.Ground_m().has_value());
  // The ray slants from above to the ground.
  const glm::dvec3 slant = glm::normalize(glm::dvec3(1.0, 0.5, -1.0));
  const StormRay down = storm.Ray({-2000.0, -1000.0, 5000.0}, slant);
  EXPECT_NEAR(down.OpticalDepth(), extinction * 2500.0 / -slant.z, 2e-3) << "the ground's metre";
  EXPECT_NEAR(*down.Ground_m(), 5000.0 / -slant.z, 1.5);
  // This ray starts inside the domain.
  EXPECT_NEAR(storm.Ray({0.0, 0.0, 1000.0}, {0.0, 1.0, 0.0}).OpticalDepth(), extinction * 4000.0,
              1e-9);
}

TEST(RayProbeTest, RaysThatMissTheDomainHaveNothing) {
  Storm storm;
  storm.Add(physics::Hydrometeor::kCloud, kExtinction_per_m);
  const RayProbe over = storm.Probe({-50000.0, 0.0, 3000.0}, {1.0, 0.0, 0.0}, 10);
  EXPECT_THAT(over.distances_m, IsEmpty());
  EXPECT_THAT(over.extinctions_per_m, IsEmpty());
  EXPECT_FALSE(over.first_cloud_m.has_value());
  ASSERT_THAT(over.fields, SizeIs(1));
  EXPECT_THAT(over.fields[0].values, IsEmpty());
  EXPECT_FALSE(over.fields[0].maximum_m.has_value());
  const StormRay away = storm.Ray({-50000.0, 0.0, 1000.0}, {-1.0, 0.0, 0.0});
  EXPECT_EQ(away.OpticalDepth(), 0.0);
  EXPECT_EQ(away.WhatIsSeen(), Seen::kSky);
  EXPECT_FALSE(away.WhereSeen_m().has_value());
  const StormRay short_of_it = storm.Ray({-50000.0, 0.0, 1000.0}, {1.0, 0.0, -1.0});
  EXPECT_EQ(short_of_it.OpticalDepth(), 0.0);
  EXPECT_EQ(short_of_it.WhatIsSeen(), Seen::kGround);
  EXPECT_NEAR(*short_of_it.WhereSeen_m(), 1000.0 * std::sqrt(2.0), 1.5);
}

TEST(RayProbeTest, ASingleCellIsATentAroundItsMiddle) {
  Storm storm;
  volume::HydrometeorField& cloud = storm.Add(physics::Hydrometeor::kCloud, 0.0);
  cloud.concentration_kg_per_m3[storm.fields.grid.Offset(10, 8, 4)] = 0.004F;
  storm.fields.condensate = {{10, 8, 4}, {11, 9, 5}};
  const glm::dvec3 middle_m(250.0, 250.0, 1125.0);
  // Through the cell's middle the extinction is a triangle two cells wide.
  const StormRay through = storm.Ray({-9000.0, 250.0, 1125.0}, {1.0, 0.0, 0.0});
  EXPECT_NEAR(through.OpticalDepth(), 0.004 * 500.0, 1e-6);
  // A ray that is a quarter of a cell to the side along y has three quarters of this optical depth.
  EXPECT_NEAR(storm.Ray({-9000.0, 375.0, 1125.0}, {1.0, 0.0, 0.0}).OpticalDepth(),
              0.75 * 0.004 * 500.0, 1e-6);
  EXPECT_EQ(storm.Ray({-9000.0, 750.0, 1125.0}, {1.0, 0.0, 0.0}).OpticalDepth(), 0.0);
  const RayProbe probe = storm.Probe({-9000.0, 250.0, 1125.0}, {1.0, 0.0, 0.0}, 21);
  EXPECT_NEAR(probe.fields[0].maximum, 0.004, 1e-8);
  EXPECT_NEAR(*probe.fields[0].maximum_m, 9250.0, 1e-6);
  EXPECT_EQ(probe.fields[0].path_kg_per_m2, 0.0) << "extinction has no mass";
  EXPECT_EQ(probe.fields[0].maximum_kg_per_m3, 0.0);
  EXPECT_NEAR(probe.fields[0].optical_depth, through.OpticalDepth(), 1e-9);
  ASSERT_THAT(probe.distances_m, SizeIs(21));
  EXPECT_NEAR(probe.distances_m.front(), 4000.0, 1e-9);
  EXPECT_NEAR(probe.distances_m.back(), 14000.0, 1e-9);
  // Samples are every 500 m from the western face; two of them lie within the triangle.
  EXPECT_NEAR(probe.fields[0].values[10], 0.002, 1e-6);
  EXPECT_NEAR(probe.fields[0].values[11], 0.002, 1e-6);
  EXPECT_EQ(probe.fields[0].values[12], 0.0F);
  EXPECT_EQ(probe.extinctions_per_m[10], probe.fields[0].values[10]);
  // Across a corner, the product of three triangles is of degree 3. The optical depth is that of 3
  // of its 8 pieces.
  const glm::dvec3 diagonal(500.0, 500.0, 250.0);
  const StormRay across = storm.Ray(middle_m - 1.5 * diagonal, diagonal);
  EXPECT_NEAR(across.OpticalDepth(), 0.004 * glm::length(diagonal) / 2.0, 1e-6)
      << "the integral of 2 u^3";
}

// Compares with many small steps, in fields of random values and for oblique rays.
TEST(RayProbeTest, RandomFieldsDepthIsThatOfSmallSteps) {
  Storm storm;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0.0F, 0.002F);
  for (const auto hydrometeor : {physics::Hydrometeor::kCloud, physics::Hydrometeor::kRain}) {
    for (float& value : storm.Add(hydrometeor, 0.0).concentration_kg_per_m3) {
      value = uniform(random);
    }
  }
  const volume::RegularGrid& grid = storm.fields.grid;
  for (const glm::dvec3& direction :
       {glm::dvec3(1.0, 0.3, 0.1), glm::dvec3(-0.2, 1.0, 0.05), glm::dvec3(0.1, 0.2, 1.0)}) {
    const glm::dvec3 origin_m(-300.0, 120.0, 700.0);
    const StormRay ray = storm.Ray(origin_m, direction);
    const RayProbe probe = ProbeRay(storm.scene, storm.fields, ray, {0, 0.1});
    constexpr int kSteps = 200'000;
    const Span span = ray.InDomain();
    double sum = 0.0;
    double largest = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const glm::dvec3 place_m = ray.At_m(glm::mix(span.begin_m, span.end_m, (i + 0.5) / kSteps));
      const glm::dvec3 at = glm::clamp((place_m - grid.low_corner_m) / grid.spacing_m - 0.5,
                                       glm::dvec3(0.0), glm::dvec3(grid.cells - 1));
      const glm::ivec3 low = glm::min(glm::ivec3(at), grid.cells - 2);
      for (std::size_t field = 0; field < 2; ++field) {
        double value = 0.0;
        for (int corner = 0; corner < 8; ++corner) {
          const glm::ivec3 side(corner & 1, (corner >> 1) & 1, corner >> 2);
          const glm::dvec3 share = glm::abs(glm::dvec3(1 - side) - (at - glm::dvec3(low)));
          const glm::ivec3 cell = low + side;
          value += share.x * share.y * share.z *
                   storm.fields.fields[field]
                       .concentration_kg_per_m3[grid.Offset(cell.x, cell.y, cell.z)];
        }
        sum += value;
        if (field == 0) largest = std::max(largest, value);
      }
    }
    const double depth = sum * (span.end_m - span.begin_m) / kSteps;
    EXPECT_NEAR(ray.OpticalDepth(), depth, 1e-6 * depth);
    EXPECT_NEAR(probe.fields[0].optical_depth + probe.fields[1].optical_depth, depth, 1e-6 * depth);
    EXPECT_NEAR(probe.fields[0].maximum, largest, 1e-5 * largest) << "half a step from its kink";
    // The optical depth in front of the returned place must be the requested one.
    const double half_m = *ray.WhereDepthIs_m(depth / 2.0);
    EXPECT_NEAR(storm.Ray(ray.At_m(half_m), direction).OpticalDepth(), depth / 2.0, 1e-6 * depth);
  }
}

TEST(RayProbeTest, MixingRatiosAreMassesOverTheAirs) {
  Storm storm;
  volume::HydrometeorField& graupel = storm.Add(physics::Hydrometeor::kGraupel, 0.003);
  graupel.quantity = volume::Quantity::kMixingRatio;
  storm.fields.air = {{1, 1}, {1.2F, 1.15F, 1.1F, 1.05F, 1.0F, 0.95F, 0.9F, 0.85F, 0.8F, 0.75F}};
  const RayProbe probe = storm.Probe({100.0, 200.0, -100.0}, {0.0, 0.0, 1.0}, 2);
  const FieldOnRay& field = probe.fields[0];
  EXPECT_NEAR(field.path_kg_per_m2, 0.003 * 2500.0, 1e-6);
  EXPECT_NEAR(field.values[0], 0.003 / 1.2, 1e-8);
  EXPECT_NEAR(field.maximum, 0.003 / 0.75, 1e-8);
  EXPECT_NEAR(*field.maximum_m, 100.0 + 2500.0 - 125.0, 1e-6);
  EXPECT_NEAR(field.maximum_kg_per_m3, 0.003, 1e-8);
  const auto drawn = DrawnFieldsOf(storm.scene, storm.fields);
  EXPECT_NEAR(field.optical_depth, 0.003 * 2500.0 * drawn[0].mass_extinction.m2_per_kg, 1e-5);
}

TEST(RayProbeTest, HiddenFieldsHaveValuesAndNoDepth) {
  Storm storm;
  storm.Add(physics::Hydrometeor::kCloud, kExtinction_per_m);
  storm.Add(physics::Hydrometeor::kRain, 0.5);
  storm.scene.fields[physics::IndexOf(physics::Hydrometeor::kRain)].visible = false;
  const RayProbe probe = storm.Probe({-6000.0, 0.0, 500.0}, {1.0, 0.0, 0.0}, 5);
  EXPECT_EQ(probe.fields[1].optical_depth, 0.0);
  EXPECT_THAT(probe.fields[1].values, Each(0.5F));
  EXPECT_THAT(probe.extinctions_per_m, Each(static_cast<float>(kExtinction_per_m)));
  EXPECT_NEAR(*probe.first_cloud_m, 1000.0 + 100.0, 1e-3);
}

TEST(RayProbeTest, AFieldThatIsZeroEverywhereIsListed) {
  Storm storm;
  storm.Add(physics::Hydrometeor::kHail, 0.0).concentration_kg_per_m3.clear();
  storm.fields.condensate = {};
  const RayProbe probe = storm.Probe({-6000.0, 0.0, 500.0}, {1.0, 0.0, 0.0}, 5);
  ASSERT_THAT(probe.fields, SizeIs(1));
  EXPECT_THAT(probe.fields[0].values, IsEmpty());
  EXPECT_THAT(probe.distances_m, SizeIs(5));
  EXPECT_THAT(probe.extinctions_per_m, Each(0.0F));
}

TEST(RayProbeTest, ADomainOfOneLevelIsASlab) {
  Storm storm;
  storm.fields.grid = {{3, 1, 1}, {1000.0, 1000.0, 400.0}, {-1500.0, -500.0, 1000.0}};
  storm.fields.terrain_height_m.assign(3, 0.0F);
  storm.fields.condensate = {{0, 0, 0}, {3, 1, 1}};
  storm.Add(physics::Hydrometeor::kCloud, 0.01);
  EXPECT_NEAR(storm.Ray({20.0, 30.0, 9000.0}, {0.0, 0.0, -1.0}).OpticalDepth(), 4.0, 1e-6);
}

TEST(RayThroughTest, AllKindsOfCamerasHaveTheRaysOfTheirPixels) {
  Storm storm;
  OrbitCamera orbit;
  orbit.target_m = {0.0, 0.0, 1000.0};
  orbit.distance_m = 20000.0;
  orbit.azimuth_deg = 180.0;
  orbit.elevation_deg = 0.0;
  orbit.field_of_view_deg = 90.0;
  storm.scene.output = {200, 100, storm.scene.output.jpeg_quality};
  storm.scene.camera = orbit;
  const ViewRay middle = RayThrough(ViewOf(storm.scene, storm.fields), 0.0, 0.0);
  EXPECT_NEAR(glm::distance(middle.direction, glm::dvec3(0.0, 1.0, 0.0)), 0.0, 1e-9);
  const ViewRay edge = RayThrough(ViewOf(storm.scene, storm.fields), 1.0, -1.0);
  EXPECT_NEAR(glm::distance(edge.direction, glm::normalize(glm::dvec3(2.0, 1.0, -1.0))), 0.0, 1e-9);
  TopDownCamera top_down;
  top_down.center_m = {1000.0, -500.0};
  top_down.width_m = 8000.0;
  storm.scene.camera = top_down;
  const ViewRay corner = RayThrough(ViewOf(storm.scene, storm.fields), -1.0, 1.0);
  EXPECT_NEAR(glm::distance(glm::dvec2(corner.origin_m), glm::dvec2(-3000.0, 1500.0)), 0.0, 1e-9);
  EXPECT_EQ(corner.direction, glm::dvec3(0.0, 0.0, -1.0));
  SpotterCamera spotter;
  spotter.place_m = {0.0, -20000.0};
  spotter.azimuth_deg = 0.0;
  spotter.elevation_deg = 0.0;
  spotter.focal_length_mm = 18.0;
  storm.scene.camera = spotter;
  const ViewRay right = RayThrough(ViewOf(storm.scene, storm.fields), 1.0, 0.0);
  EXPECT_NEAR(right.direction.x, std::sqrt(0.5), 1e-5) << "45 degrees, on a round Earth";
  EXPECT_NEAR(right.origin_m.z, 1.7 - 0.5 * 20000.0 * 20000.0 / kEffectiveEarthRadius_m, 0.1);
}

}  // namespace
}  // namespace thunderhead::scene
