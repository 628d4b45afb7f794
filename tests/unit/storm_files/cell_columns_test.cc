// Tests of even columns of unstructured grids. Places come from formulas, and not from PROJ.
#include "storm_files/cell_columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "glm/geometric.hpp"
#include "storm_files/resampled_columns.h"
#include "tests/support/earth_formulas.h"
#include "tests/unit/storm_files/cell_meshes.h"
#include "volume/map_projection.h"

// Tests are compiled together, and other tests have the same names.
namespace thunderhead::storm_files::cell_columns_test {
namespace {

using testing::CellMesh;
using testing::Distance_m;
using testing::FromStereographic;
using ::testing::HasSubstr;
using testing::Hexagons;
using testing::Triangles;
using volume::EarthPlace;

CellPlaces PlacesOf(const std::vector<glm::dvec2>& plane_m, const EarthPlace& middle) {
  CellPlaces places;
  places.radius_m = testing::kEarth_m;
  for (const glm::dvec2& at_m : plane_m) {
    const EarthPlace place = FromStereographic(at_m, middle);
    places.latitude_deg.push_back(place.latitude_deg);
    places.longitude_deg.push_back(place.longitude_deg);
  }
  return places;
}

// Moves each centre by up to a share of the spacing, so that cells are irregular.
CellMesh Shaken(CellMesh mesh, double share) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> way(-share * mesh.spacing_m, share * mesh.spacing_m);
  for (glm::dvec2& at_m : mesh.centres_m) at_m += glm::dvec2(way(random), way(random));
  return mesh;
}

// A blob whose amount falls off with the distance from a place on the plane.
struct Blob {
  glm::dvec2 centre_m{0.0};
  double width_m = 0.0;

  float At(const glm::dvec2& plane_m) const {
    const double distance = glm::distance(plane_m, centre_m) / width_m;
    return static_cast<float>(std::exp(-distance * distance));
  }
  double Sum_m2() const { return testing::kPi * width_m * width_m; }
};

EarthPlace PlaceOfColumn(const EvenColumns& even, const volume::MapProjection& map, int x, int y) {
  const glm::dvec2 world_m =
      (glm::dvec2(x, y) - 0.5 * glm::dvec2(even.columns - 1)) * glm::dvec2(even.dx_m, even.dy_m);
  return map.PlaceOf(world_m).value_or(EarthPlace{});
}

struct Found {
  double sum_m2 = 0.0;
  float largest = 0.0F;
  double off_m = 0.0;  // distance of the blob's centroid from the right place
};

// Resamples a blob.
Found Resample(const CellMesh& mesh, const EvenColumns& even, const Blob& blob,
               const EarthPlace& middle) {
  std::vector<float> values;
  for (const glm::dvec2& at_m : mesh.centres_m) values.push_back(blob.At(at_m));
  std::vector<float> resampled = Resampled(even, values, Beyond::kZero);
  const double factor = SumFactor(even, values, resampled);
  const auto map = volume::MapProjection::Of(even.projection, even.middle);
  EXPECT_TRUE(map.ok()) << map.status();
  Found found;
  glm::dvec2 centroid(0.0);
  double sum = 0.0;
  for (int y = 0; y < even.columns.y; ++y) {
    for (int x = 0; x < even.columns.x; ++x) {
      const float value = resampled[static_cast<std::size_t>(y * even.columns.x + x)];
      centroid += static_cast<double>(value) * glm::dvec2(x, y);
      sum += value;
      found.largest = std::max(found.largest, value);
    }
  }
  found.sum_m2 = factor * sum * even.dx_m * even.dy_m;
  centroid = (centroid / sum - 0.5 * glm::dvec2(even.columns - 1)) * even.dx_m;
  found.off_m = Distance_m(map->PlaceOf(centroid).value_or(EarthPlace{}),
                           FromStereographic(blob.centre_m, middle));
  return found;
}

TEST(CellColumns, ABlobKeepsItsPlaceSizeAndMass) {
  const std::vector<CellMesh> meshes = {
      Triangles({120e3, 90e3}, 2500.0), Hexagons({120e3, 90e3}, 2000.0),
      Shaken(Triangles({120e3, 90e3}, 2500.0), 0.15), Shaken(Hexagons({120e3, 90e3}, 2000.0), 0.2)};
  // Over land, across the date line, and around the pole.
  for (const EarthPlace middle :
       {EarthPlace{48.0, 11.0}, EarthPlace{-15.0, 179.9}, EarthPlace{89.9, 0.0}}) {
    for (const CellMesh& mesh : meshes) {
      const auto even = MakeEvenOfCells(PlacesOf(mesh.centres_m, middle));
      ASSERT_TRUE(even.ok()) << even.status();
      EXPECT_EQ(even->model_columns, glm::ivec2(mesh.centres_m.size(), 1));
      EXPECT_LE(even->dx_m, 1.01 * mesh.spacing_m);
      EXPECT_GE(even->dx_m, 0.6 * mesh.spacing_m);
      const Blob blob{{20e3, -10e3}, 12e3};
      const Found found = Resample(mesh, *even, blob, middle);
      EXPECT_NEAR(found.sum_m2 / blob.Sum_m2(), 1.0, 0.005);
      EXPECT_NEAR(found.largest, 1.0, 0.01);
      EXPECT_LT(found.off_m, 0.25 * mesh.spacing_m);
    }
  }
}

TEST(CellColumns, EachColumnHasTheNearestCell) {
  const CellMesh mesh = Shaken(Triangles({40e3, 30e3}, 2500.0), 0.2);
  const EarthPlace middle{60.0, 25.0};
  const CellPlaces places = PlacesOf(mesh.centres_m, middle);
  const auto even = MakeEvenOfCells(places);
  ASSERT_TRUE(even.ok()) << even.status();
  const auto map = volume::MapProjection::Of(even->projection, even->middle);
  ASSERT_TRUE(map.ok()) << map.status();
  int inside = 0;
  for (int y = 0; y < even->columns.y; ++y) {
    for (int x = 0; x < even->columns.x; ++x) {
      const EarthPlace column = PlaceOfColumn(*even, *map, x, y);
      double nearest_m = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < places.latitude_deg.size(); ++i) {
        nearest_m = std::min(nearest_m,
                             Distance_m(column, {places.latitude_deg[i], places.longitude_deg[i]}));
      }
      const auto at = static_cast<std::size_t>(y * even->columns.x + x);
      const std::size_t cell = NearestColumn(*even, at);
      ASSERT_LT(cell, places.latitude_deg.size());
      EXPECT_NEAR(Distance_m(column, {places.latitude_deg[cell], places.longitude_deg[cell]}),
                  nearest_m, 1.0);
      inside += even->from[at].inside ? 1 : 0;
      EXPECT_TRUE(even->from[at].inside || nearest_m > 1.2 * 0.5 * mesh.spacing_m);
    }
  }
  EXPECT_GT(inside, even->columns.x * even->columns.y * 9 / 10);
}

TEST(CellColumns, PlacesFarFromAllCellsAreOutside) {
  CellMesh mesh = Hexagons({60e3, 60e3}, 2000.0);
  std::erase_if(mesh.centres_m,
                [](const glm::dvec2& at_m) { return at_m.x > 0.0 && at_m.y > 0.0; });
  const auto even = MakeEvenOfPlane(mesh.centres_m);
  ASSERT_TRUE(even.ok()) << even.status();
  EXPECT_TRUE(even->projection.empty());
  const auto ones =
      Resampled(*even, std::vector<float>(mesh.centres_m.size(), 1.0F), Beyond::kZero);
  const auto at = [&](double x, double y) {  // shares of the domain
    const glm::ivec2 column(x * even->columns.x, y * even->columns.y);
    return ones[static_cast<std::size_t>(column.y * even->columns.x + column.x)];
  };
  EXPECT_EQ(at(0.75, 0.75), 0.0F);
  EXPECT_EQ(at(0.6, 0.6), 0.0F);
  EXPECT_EQ(at(0.25, 0.25), 1.0F);
  EXPECT_EQ(at(0.75, 0.25), 1.0F);
  // The areas of the cells cover the domain, whose edges reach at most a cell too far.
  const double area_m2 = std::accumulate(even->model_areas.begin(), even->model_areas.end(), 0.0) *
                         even->dx_m * even->dy_m;
  EXPECT_NEAR(area_m2 / (mesh.area_m2 * static_cast<double>(mesh.centres_m.size())), 1.04, 0.04);
}

// The cells of a mesh may be smaller in the middle. The larger ones leave no gaps.
TEST(CellColumns, LargeCellsAreFilled) {
  CellMesh mesh = Hexagons({100e3, 100e3}, 2000.0);
  for (glm::dvec2& at_m : mesh.centres_m) at_m *= 1.0 + glm::dot(at_m, at_m) / (70e3 * 70e3);
  const auto even = MakeEvenOfPlane(mesh.centres_m);
  ASSERT_TRUE(even.ok()) << even.status();
  EXPECT_GT(even->longest_m.x, 1.4 * even->dx_m);
  int outside = 0;
  for (int y = even->columns.y / 4; y < even->columns.y * 3 / 4; ++y) {
    for (int x = even->columns.x / 4; x < even->columns.x * 3 / 4; ++x) {
      outside += even->from[static_cast<std::size_t>(y * even->columns.x + x)].inside ? 0 : 1;
    }
  }
  EXPECT_EQ(outside, 0);
  EXPECT_LE(even->columns.x * even->columns.y, 4 * static_cast<int>(mesh.centres_m.size()) + 16);
}

TEST(CellColumns, WideDomainsStateTheirErrors) {
  const EarthPlace middle{48.0, 11.0};
  const auto narrow = MakeEvenOfCells(PlacesOf(Triangles({60e3, 60e3}, 2500.0).centres_m, middle));
  ASSERT_TRUE(narrow.ok()) << narrow.status();
  EXPECT_EQ(AssumptionsOf(*narrow).size(), 1U);
  // The corners are 2900 km from the middle.
  const CellMesh mesh = Hexagons({4.3e6, 4.3e6}, 60e3);
  const auto wide = MakeEvenOfCells(PlacesOf(mesh.centres_m, middle));
  ASSERT_TRUE(wide.ok()) << wide.status();
  double farthest_m = 0.0;
  for (const glm::dvec2& at_m : mesh.centres_m) {
    farthest_m = std::max(farthest_m, Distance_m(FromStereographic(at_m, middle), middle));
  }
  EXPECT_NEAR(wide->reach_m, farthest_m, 0.5 * mesh.spacing_m);
  const double angle = wide->reach_m / testing::kEarth_m;
  EXPECT_NEAR(wide->largest_scale, 2.0 / (1.0 + std::cos(angle)), 1e-9);
  ASSERT_EQ(AssumptionsOf(*wide).size(), 2U);
  EXPECT_THAT(AssumptionsOf(*wide)[1], HasSubstr("no flat map"));
}

TEST(CellColumns, RefusesWhatHasNoAreaOrIsTooWide) {
  const EarthPlace middle{48.0, 11.0};
  const auto expect = [](const CellPlaces& places, const std::string& what) {
    const auto even = MakeEvenOfCells(places);
    ASSERT_FALSE(even.ok()) << what;
    EXPECT_THAT(std::string(even.status().message()), HasSubstr(what));
  };
  const CellMesh mesh = Triangles({60e3, 60e3}, 2500.0);
  CellPlaces places = PlacesOf(mesh.centres_m, middle);
  places.latitude_deg[7] = std::nan("");
  expect(places, "cell 7");
  places.latitude_deg[7] = 91.0;
  expect(places, "cell 7");
  expect(PlacesOf({{0.0, 0.0}, {1e3, 0.0}, {0.0, 1e3}}, middle), "3 cells");
  expect(PlacesOf(std::vector<glm::dvec2>(100, glm::dvec2(1e3)), middle), "no area");
  std::vector<glm::dvec2> line;
  std::vector<glm::dvec2> pairs;
  for (int i = 0; i < 100; ++i) {
    const int row = i / 10;
    line.emplace_back(1e3 * i, 500.0 * i);
    pairs.emplace_back(1e3 * (i % 10), 1e3 * row);
    pairs.push_back(pairs.back());
  }
  expect(PlacesOf(line, middle), "no area");
  expect(PlacesOf(pairs, middle), "at the same place");
  CellPlaces meridian;
  for (int i = -40; i <= 40; ++i) {
    meridian.latitude_deg.push_back(2.0 * i);
    meridian.longitude_deg.push_back(135.0);
  }
  expect(meridian, "no area");
  CellPlaces wide;
  for (int i = 0; i < 60 * 80; ++i) {
    const int row = i / 80;
    wide.latitude_deg.push_back(-40.0 + 2.0 * row);
    wide.longitude_deg.push_back(-100.0 + 2.5 * (i % 80));
  }
  expect(wide, "farther than a hemisphere; cut a region");
  CellPlaces globe;
  for (int i = 0; i < 2000; ++i) {
    globe.latitude_deg.push_back(glm::degrees(std::asin(-1.0 + (i + 0.5) / 1000.0)));
    globe.longitude_deg.push_back(137.507764 * i - 360.0 * std::floor(137.507764 * i / 360.0));
  }
  expect(globe, "all around the Earth");
}

}  // namespace
}  // namespace thunderhead::storm_files::cell_columns_test
