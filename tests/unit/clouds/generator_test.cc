#include "clouds/generator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/resource.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>

#include "clouds/presets.h"
#include "glm/geometric.hpp"
#include "storm_files/cf_writer.h"
#include "storm_store/storm_store.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::clouds {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

CloudShape Ball() {
  CloudShape shape;
  shape.grid = {{24, 20, 16}, {50.0, 50.0, 50.0}, {-600.0, -500.0, 0.0}};
  shape.noise.octaves = 3;
  shape.threshold = 0.05;
  shape.ellipsoids = {{{0.0, 0.0, 400.0}, {400.0, 300.0, 200.0}, {10.0, 20.0, 30.0}}};
  return shape;
}

std::vector<float> Made(const CloudShape& shape) {
  auto water = Generate(shape, {}, {});
  EXPECT_TRUE(water.ok()) << water.status();
  return water.ok() ? *std::move(water) : std::vector<float>{};
}

// Returns the FNV-1a hash of the bits of every value.
std::uint64_t Hash(const std::vector<float>& values) {
  std::uint64_t hash = 14695981039346656037U;
  for (const float value : values) {
    hash = (hash ^ std::bit_cast<std::uint32_t>(value)) * 1099511628211U;
  }
  return hash;
}

glm::dvec3 Middle_m(const volume::RegularGrid& grid, int x, int y, int z) {
  return grid.low_corner_m + (glm::dvec3(x, y, z) + 0.5) * grid.spacing_m;
}

TEST(Quadric, IsOneAtTheCentreAndZeroAtTheEndsOfItsAxes) {
  const Ellipsoid ellipsoid{{100.0, -50.0, 900.0}, {300.0, 200.0, 100.0}, {25.0, -40.0, 110.0}};
  const Quadric quadric(ellipsoid);
  EXPECT_EQ(quadric.Value(ellipsoid.centre_m), 1.0);
  // The rotations are about x, then y, then z.
  const auto turn = [](glm::dvec3 v, int axis, double degrees) {
    const double s = std::sin(degrees * M_PI / 180.0);
    const double c = std::cos(degrees * M_PI / 180.0);
    const int i = (axis + 1) % 3;
    const int j = (axis + 2) % 3;
    const double a = v[i];
    const double b = v[j];
    v[i] = c * a - s * b;
    v[j] = s * a + c * b;
    return v;
  };
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 end(0.0);
    end[axis] = ellipsoid.radii_m[axis];
    for (int about = 0; about < 3; ++about) end = turn(end, about, ellipsoid.rotation_deg[about]);
    EXPECT_NEAR(quadric.Value(ellipsoid.centre_m + end), 0.0, 1e-12) << axis;
    EXPECT_NEAR(quadric.Value(ellipsoid.centre_m - 0.5 * end), 0.75, 1e-12) << axis;
    for (int i = 0; i < 3; ++i) EXPECT_GE(quadric.HalfExtent_m()[i] + 1e-9, std::abs(end[i]));
  }
}

// Compares every cell with the plain formulas.
TEST(Generate, IsNoiseTimesModulationAboveTheThreshold) {
  CloudShape shape = Ball();
  shape.dynamics = 0.8;
  shape.base_m = 330.0;
  shape.ellipsoids.push_back({{-300.0, 100.0, 500.0}, {150.0, 150.0, 150.0}, {}});
  const std::vector<float> water = Made(shape);
  const Quadric first(shape.ellipsoids[0]);
  const Quadric second(shape.ellipsoids[1]);
  const volume::RegularGrid& grid = shape.grid;
  int filled = 0;
  for (int z = 0; z < grid.cells.z; ++z) {
    for (int y = 0; y < grid.cells.y; ++y) {
      for (int x = 0; x < grid.cells.x; ++x) {
        const glm::dvec3 p = Middle_m(grid, x, y, z);
        const glm::dvec3 at = p / shape.feature_m;
        const double q = std::max({first.Value(p), second.Value(p), 0.0});
        const double density = Noise(shape.noise, at.x, at.y, at.z) * q;
        const bool empty = density < shape.threshold || density <= 0.0 || p.z < 330.0;
        const double expected = empty ? 0.0 : 0.8 * density * shape.water_kg_per_m3;
        EXPECT_NEAR(water[grid.Offset(x, y, z)], expected, 1e-9);
        filled += empty ? 0 : 1;
      }
    }
  }
  EXPECT_GT(filled, 100);
}

// The generated cloud's values must have these bits on every machine.
TEST(Generate, GivesTheSameBitsEverywhere) {
  EXPECT_EQ(Hash(Made(Ball())), 8239800386922749215U);
  CloudShape cubic = Ball();
  cubic.noise.interpolation = NoiseInterpolation::kCubic;
  cubic.noise.seed = 12345;
  EXPECT_EQ(Hash(Made(cubic)), 13680479665035534604U);
}

TEST(Generate, SeedsGiveDifferentClouds) {
  CloudShape other = Ball();
  other.noise.seed = 2;
  EXPECT_NE(Hash(Made(Ball())), Hash(Made(other)));
}

TEST(Generate, RefusesWhatMakesNoSense) {
  struct Case {
    void (*change)(CloudShape*);
    const char* text;
  };
  const Case cases[] = {
      {[](CloudShape* s) { s->noise.octaves = 0; }, "octaves"},
      {[](CloudShape* s) { s->noise.octaves = 12; }, "too fine"},
      {[](CloudShape* s) { s->noise.persistence = -0.5; }, "persistence"},
      {[](CloudShape* s) { s->feature_m = 0.0; }, "feature"},
      {[](CloudShape* s) { s->threshold = 1.0; }, "threshold"},
      {[](CloudShape* s) { s->threshold = std::nan(""); }, "threshold"},
      {[](CloudShape* s) { s->dynamics = 0.0; }, "dynamics"},
      {[](CloudShape* s) { s->water_kg_per_m3 = -1.0; }, "water"},
      {[](CloudShape* s) { s->ellipsoids.clear(); }, "ellipsoid"},
      {[](CloudShape* s) { s->ellipsoids[0].radii_m.y = -3.0; }, "radius"},
      {[](CloudShape* s) { s->ellipsoids[0].centre_m.x = std::numeric_limits<double>::infinity(); },
       "finite"},
      {[](CloudShape* s) { s->ellipsoids[0].centre_m.x = 1e6; }, "no cell"},
      {[](CloudShape* s) { s->threshold = 0.999; }, "no cell"},
      {[](CloudShape* s) { s->grid.cells.z = 0; }, "cells"},
      {[](CloudShape* s) { s->grid.spacing_m.x = -1.0; }, "cell"}};
  for (const Case& c : cases) {
    CloudShape shape = Ball();
    c.change(&shape);
    const auto water = Generate(shape, {}, {});
    EXPECT_EQ(water.status().code(), absl::StatusCode::kInvalidArgument) << c.text;
    EXPECT_THAT(std::string(water.status().message()), HasSubstr(c.text));
  }
}

TEST(Generate, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(Generate(Ball(), {}, stop.get_token()).status().code(), absl::StatusCode::kCancelled);
}

TEST(Presets, AreCloudsInsideTheirDomains) {
  EXPECT_THAT(PresetNames(), ElementsAre("congestus", "cumulus-field", "fair-weather-cumulus"));
  EXPECT_THAT(std::string(PresetNamed("cirrus", 1).status().message()), HasSubstr("congestus"));
  for (const std::string& name : PresetNames()) {
    SCOPED_TRACE(name);
    const CloudShape shape = *PresetNamed(name, 1);
    const std::vector<float> water = Made(shape);
    const volume::RegularGrid& grid = shape.grid;
    double mean = 0.0;
    float largest = 0.0F;
    std::size_t filled = 0;
    for (int z = 0; z < grid.cells.z; ++z) {
      for (int y = 0; y < grid.cells.y; ++y) {
        for (int x = 0; x < grid.cells.x; ++x) {
          const float value = water[grid.Offset(x, y, z)];
          const bool edge = x == 0 || y == 0 || z == 0 || x == grid.cells.x - 1 ||
                            y == grid.cells.y - 1 || z == grid.cells.z - 1;
          ASSERT_TRUE(!edge || value == 0.0F) << x << " " << y << " " << z;
          filled += value > 0.0F ? 1 : 0;
          mean += value;
          largest = std::max(largest, value);
        }
      }
    }
    // Measured values in cumulus are some 0.1 to 1 g/m3, in congestus up to 3.
    mean /= static_cast<double>(filled);
    EXPECT_GT(mean, 1e-4);
    EXPECT_LT(mean, 1.5e-3);
    EXPECT_LT(largest, 5e-3F);
    EXPECT_GT(filled, grid.CellCount() / 200);
  }
}

// The program's own reader reads back what WriteCfCloud writes.
TEST(WriteCfCloud, ReadsBackAsItWas) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("ball.nc");
  const CloudShape shape = Ball();
  const std::vector<float> water = Made(shape);
  ASSERT_TRUE(
      storm_files::WriteCfCloud(
          {shape.grid, volume::Quantity::kMassConcentration, water, "ball", "test", "none"}, path)
          .ok());
  auto store = storm_store::StormStore::Open({path}, {.read_ahead = 0});
  ASSERT_TRUE(store.ok()) << store.status();
  const auto fields = (*store)->Get("ball", 0, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(glm::length((*fields)->grid.spacing_m - shape.grid.spacing_m), 0.0, 1e-9);
  EXPECT_NEAR(glm::length((*fields)->grid.low_corner_m - shape.grid.low_corner_m), 0.0, 1e-9);
  EXPECT_EQ((*fields)->fields[0].concentration_kg_per_m3, water);
  ASSERT_TRUE(storm_files::WriteCfCloud(
                  {shape.grid, volume::Quantity::kExtinction, water, "ball", "test", "none"}, path)
                  .ok());
  store = storm_store::StormStore::Open({path}, {.read_ahead = 0});
  ASSERT_TRUE(store.ok()) << store.status();
  const auto extinction = (*store)->Get("ball", 0, {});
  ASSERT_TRUE(extinction.ok()) << extinction.status();
  EXPECT_EQ((*extinction)->fields[0].quantity, volume::Quantity::kExtinction);
  EXPECT_EQ((*extinction)->fields[0].concentration_kg_per_m3, water);
  const absl::Status nowhere = storm_files::WriteCfCloud(
      {shape.grid, volume::Quantity::kExtinction, water, "", "", ""}, folder.File("none/ball.nc"));
  EXPECT_THAT(std::string(nowhere.message()),
              HasSubstr("none/ball.nc cannot be written (No such file or directory)"));
}

// A limit on the size of files stands for a full disk.
TEST(WriteCfCloud, NamesTheCauseIfItCannotBeWritten) {
  const testing::TemporaryFolder folder;
  const CloudShape shape = Ball();
  const std::vector<float> water = Made(shape);
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit small{.rlim_cur = 1000, .rlim_max = limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const absl::Status full = storm_files::WriteCfCloud(
      {shape.grid, volume::Quantity::kMassConcentration, water, "", "", ""},
      folder.File("ball.nc"));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  std::signal(SIGXFSZ, before);
  EXPECT_THAT(std::string(full.message()), HasSubstr("ball.nc cannot be written (File too large)"));
  EXPECT_FALSE(std::filesystem::exists(folder.File("ball.nc.partial")));
}

}  // namespace
}  // namespace thunderhead::clouds
