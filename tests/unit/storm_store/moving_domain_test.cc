// Tests that each time of a domain that moves is at its own place, with its own distances, map and
// true north. It does not matter which file a time is in.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "storm_store/storm_store.h"
#include "tests/support/earth_formulas.h"
#include "tests/support/synthetic_cf.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::storm_store {
namespace {

using testing::Distance_m;
using testing::SyntheticWrf;
using testing::WrfCell;
using volume::EarthPlace;

constexpr int kMovingTimes = 3;
constexpr int kColumns = 48;
constexpr int kRows = 40;
// Three clouds, each of 3 by 3 columns, and the column in the middle of each.
constexpr std::array kClouds = {glm::ivec2(6, 5), glm::ivec2(24, 30), glm::ivec2(41, 9)};

bool IsCloud(int x, int y) {
  return std::ranges::any_of(kClouds, [&](const glm::ivec2& cloud) {
    return std::abs(x - cloud.x) < 2 && std::abs(y - cloud.y) < 2;
  });
}

// Returns the place of a column. Columns are counted from the south-west, in halves too.
using PlaceOfColumn = std::function<EarthPlace(const glm::dvec2& column, int time)>;

// A nest in a Mercator projection whose scale is true at the equator. It moves 13 degrees north.
EarthPlace OnMercator(const glm::dvec2& column, int time) {
  return testing::FromMercator(glm::dvec2(-290e3, 1.6e6) + 1e4 * column +
                                   static_cast<double>(time) * glm::dvec2(-400e3, 800e3),
                               0.0, -89.0);
}

// A small nest in a Lambert projection, whose columns stay as they are. It moves 11 degrees north.
EarthPlace OnLambert(const glm::dvec2& column, int time) {
  static const testing::LambertFormulas kLambert(30.0, 60.0, -97.0);
  return kLambert.PlaceOf(glm::dvec2(2.0e5, -kLambert.FromTip_m(42.0)) + 3e3 * column +
                          static_cast<double>(time) * glm::dvec2(500e3, 600e3));
}

std::string Hour(int time) { return "2013-05-20_" + std::to_string(18 + time) + ":00:00"; }

// Writes a file of WRF with the times `first` to `last`.
void WriteWrfTimes(const PlaceOfColumn& place, int map_projection, int first, int last,
                   const std::string& path) {
  SyntheticWrf file;
  file.nx = kColumns;
  file.ny = kRows;
  file.levels = 3;
  file.domain = 3;
  file.dx_m = file.dy_m = map_projection == 3 ? 1e4 : 3e3;
  file.map_projection = map_projection;
  file.numbers = map_projection == 3
                     ? std::map<std::string, double>{{"TRUELAT1", 0.0}, {"STAND_LON", -89.0}}
                     : std::map<std::string, double>{
                           {"TRUELAT1", 30.0}, {"TRUELAT2", 60.0}, {"STAND_LON", -97.0}};
  file.times.clear();
  for (int time = first; time <= last; ++time) file.times.push_back(Hour(time));
  const auto at = [=](const WrfCell& cell) {
    return place({cell.x, cell.y}, first + static_cast<int>(cell.record));
  };
  file.columns["XLAT"] = [=](const WrfCell& cell) { return at(cell).latitude_deg; };
  file.columns["XLONG"] = [=](const WrfCell& cell) { return at(cell).longitude_deg; };
  file.mixing_ratios["QCLOUD"] = [](const WrfCell& cell) {
    return IsCloud(cell.x, cell.y) ? 1e-3 : 0.0;
  };
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  testing::WriteWrf(file, path);
}

// A grid of longitudes and latitudes. It moves 10 degrees north.
EarthPlace OnDegrees(const glm::dvec2& column, int time) {
  return {15.05 + 0.1 * column.y + 5.0 * time, -89.0 + 0.1 * column.x - 2.0 * time};
}

// Writes a CF file with the times `first` to `last`. If `listed`, each column has its longitude and
// latitude at each time. Otherwise there is a longitude for each x and a latitude for each y.
void WriteCfTimes(const PlaceOfColumn& place, bool listed, int first, int last,
                  const std::string& path) {
  using Index = std::map<std::string, std::size_t>;
  testing::SyntheticCf file = testing::ExtinctionFile(kColumns, kRows, 3, 1.0, 1.0, 500.0, {});
  file.variables[0] = {
      "qc", {"time", "z", "y", "x"}, {{"units", "kg m-3"}}, [](const Index& at) {
        return IsCloud(static_cast<int>(at.at("x")), static_cast<int>(at.at("y"))) ? 1e-3 : 0.0;
      }};
  testing::CfCoordinate times{"time", {}, {{"units", "hours since 2013-05-20 18:00:00"}}, {}};
  for (int time = first; time <= last; ++time) times.values.push_back(time);
  file.coordinates.push_back(times);
  for (testing::CfCoordinate& axis : file.coordinates) {
    const bool is_x = axis.name == "x";
    if (!is_x && axis.name != "y") continue;
    axis.faces.clear();
    axis.attributes = {{"units", is_x ? "degrees_east" : "degrees_north"}};
    axis.written = !listed;
    for (std::size_t i = 0; i < axis.values.size(); ++i) {
      const auto at = static_cast<double>(i);
      const EarthPlace there = place(is_x ? glm::dvec2(at, 0.0) : glm::dvec2(0.0, at), first);
      axis.values[i] = is_x ? there.longitude_deg : there.latitude_deg;
    }
  }
  for (const bool latitude : {true, false}) {
    if (!listed) continue;
    file.variables.push_back({latitude ? "lat" : "lon",
                              {"time", "y", "x"},
                              {{"units", latitude ? "degrees_north" : "degrees_east"}},
                              [=](const Index& at) {
                                const EarthPlace there =
                                    place({at.at("x"), at.at("y")},
                                          first + static_cast<int>(at.at("time")));
                                return latitude ? there.latitude_deg : there.longitude_deg;
                              }});
  }
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  testing::WriteCf(file, path);
}

// Returns the middle of the cloud of which a part is within `reach_m` of a place, in the world.
glm::dvec2 CloudNear_m(const volume::HydrometeorFields& fields, const glm::dvec2& near_m,
                       double reach_m) {
  glm::dvec2 moment_m(0.0);
  double sum = 0.0;
  for (int y = 0; y < fields.grid.cells.y; ++y) {
    for (int x = 0; x < fields.grid.cells.x; ++x) {
      const glm::dvec2 at_m = glm::dvec2(fields.grid.low_corner_m) +
                              (glm::dvec2(x, y) + 0.5) * glm::dvec2(fields.grid.spacing_m);
      if (glm::distance(at_m, near_m) > reach_m) continue;
      const double value = fields.fields[0].concentration_kg_per_m3[fields.grid.Offset(x, y, 1)];
      moment_m += value * at_m;
      sum += value;
    }
  }
  return moment_m / sum;
}

class MovingDomain : public ::testing::Test {
 protected:
  // Opens the only storm under the folder `name`.
  void Open(const std::string& name) {
    auto store = StormStore::Open({folder_.File(name)}, {.read_ahead = 0});
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
    ASSERT_EQ(store_->Storms().size(), 1U);
    ASSERT_EQ(store_->Storms()[0]->times.size(), static_cast<std::size_t>(kMovingTimes));
  }

  // Expects every time to be right in place, size and direction.
  void ExpectPlaces(const PlaceOfColumn& place_at) {
    const StormInfo& info = *store_->Storms()[0];
    for (int time = 0; time < kMovingTimes; ++time) {
      SCOPED_TRACE(time);
      const auto fields = store_->Get(info.id, time, {});
      ASSERT_TRUE(fields.ok()) << fields.status();
      const volume::RegularGrid& grid = (*fields)->grid;
      const auto projection = ProjectionOf(info, static_cast<std::size_t>(time));
      ASSERT_TRUE(projection.has_value());
      for (const glm::ivec2& cloud : kClouds) {
        const auto world_m = projection->WorldOf(place_at(cloud, time));
        ASSERT_TRUE(world_m.has_value());
        const glm::dvec2 found_m = CloudNear_m(**fields, *world_m, 6.0 * grid.spacing_m.x);
        EXPECT_LT(glm::distance(found_m, *world_m), 0.3 * grid.spacing_m.x);
      }
      // A length in the world is a true length.
      for (const glm::dvec2& half_m : {glm::dvec2(0.4 * kColumns * grid.spacing_m.x, 0.0),
                                       glm::dvec2(0.0, 0.4 * kRows * grid.spacing_m.y)}) {
        const double true_m =
            Distance_m(*projection->PlaceOf(-half_m), *projection->PlaceOf(half_m));
        EXPECT_NEAR(true_m / (2.0 * glm::length(half_m)), 1.0, 0.003);
      }
      // The grid covers the model's domain. It may have one column more to cover the last place,
      // and one more to have an even number of columns like the model.
      const glm::dvec2 last(kColumns - 1, kRows - 1);
      const double width_m =
          Distance_m(place_at({0.0, 0.5 * last.y}, time), place_at({last.x, 0.5 * last.y}, time));
      const double columns = grid.cells.x * grid.spacing_m.x / (width_m / last.x);
      EXPECT_GT(columns, kColumns - 0.5);
      EXPECT_LT(columns, kColumns + 2.1);
      const EarthPlace middle = *MiddleOf(info, static_cast<std::size_t>(time));
      EXPECT_LT(Distance_m(middle, place_at(0.5 * last, time)), 0.05 * grid.spacing_m.x);
      const EarthPlace north{middle.latitude_deg + 0.1, middle.longitude_deg};
      const glm::dvec2 way_m = *projection->WorldOf(north) - *projection->WorldOf(middle);
      const double north_deg = glm::degrees(std::atan2(way_m.x, way_m.y));
      EXPECT_NEAR(TrueNorthOf_deg(info, static_cast<std::size_t>(time)), north_deg, 0.02);
      EXPECT_NEAR((*fields)->true_north_deg, north_deg, 0.02);
    }
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<StormStore> store_;
};

TEST_F(MovingDomain, EachTimeOfANestOfWrfIsAtItsPlaceWhicheverFileHasIt) {
  for (const auto& [map_projection, place] : {std::pair<int, PlaceOfColumn>{3, OnMercator},
                                              std::pair<int, PlaceOfColumn>{1, OnLambert}}) {
    // The times 0 to `together` are in the first file. Each other time has its own file.
    for (int together = 0; together < kMovingTimes; ++together) {
      SCOPED_TRACE(::testing::Message() << "projection " << map_projection << ", times 0 to "
                                        << together << " in one file");
      const std::string folder = "run " + std::to_string(map_projection) + std::to_string(together);
      WriteWrfTimes(place, map_projection, 0, together, folder_.File(folder + "/wrfout_0"));
      for (int time = together + 1; time < kMovingTimes; ++time) {
        WriteWrfTimes(place, map_projection, time, time,
                      folder_.File(folder + "/wrfout_" + std::to_string(time)));
      }
      ASSERT_NO_FATAL_FAILURE(Open(folder));
      ExpectPlaces(place);
    }
  }
}

TEST_F(MovingDomain, EachFileOfASeriesByCfIsAtItsPlace) {
  for (int time = 0; time < kMovingTimes; ++time) {
    WriteCfTimes(OnDegrees, false, time, time, folder_.File("run/" + std::to_string(time) + ".nc"));
  }
  ASSERT_NO_FATAL_FAILURE(Open("run"));
  ExpectPlaces(OnDegrees);
}

TEST_F(MovingDomain, EachTimeOfAFileByCfWithListedPlacesIsAtItsPlace) {
  WriteCfTimes(OnMercator, true, 0, kMovingTimes - 1, folder_.File("run/all.nc"));
  ASSERT_NO_FATAL_FAILURE(Open("run"));
  ExpectPlaces(OnMercator);
}

}  // namespace
}  // namespace thunderhead::storm_store
