#include "volume/place_table.h"

#include <cmath>
#include <string>

#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "gtest/gtest.h"

namespace thunderhead::volume {
namespace {

TEST(PlaceTableTest, NodesAreAtTheirDistanceAndDirection) {
  const EarthPlace middle{40.0, 179.0};
  const EarthPlace east = PlaceAround({0.0, 179.0}, glm::radians(2.0), 0.0);
  EXPECT_NEAR(east.latitude_deg, 0.0, 1e-9);
  EXPECT_NEAR(east.longitude_deg, -179.0, 1e-9);
  const EarthPlace north = PlaceAround(middle, 0.0, glm::radians(3.0));
  EXPECT_NEAR(north.latitude_deg, 43.0, 1e-9);
  EXPECT_NEAR(north.longitude_deg, 179.0, 1e-9);
  const EarthPlace across_pole = PlaceAround(middle, 0.0, glm::radians(60.0));
  EXPECT_NEAR(across_pole.latitude_deg, 80.0, 1e-9);
  EXPECT_NEAR(across_pole.longitude_deg, -1.0, 1e-9);
  const double u = 0.3;
  const double v = -0.2;
  const EarthPlace place = PlaceAround(middle, u, v);
  const auto sine = [](double degrees) { return std::sin(glm::radians(degrees)); };
  const auto cosine = [](double degrees) { return std::cos(glm::radians(degrees)); };
  const double distance =
      std::acos(sine(40.0) * sine(place.latitude_deg) +
                cosine(40.0) * cosine(place.latitude_deg) * cosine(place.longitude_deg - 179.0));
  EXPECT_NEAR(distance, std::hypot(u, v), 1e-9);
}

TEST(PlaceTableTest, HoldsTheWorldCoordinatesOfItsNodes) {
  const EarthPlace middle{35.0, -90.0};
  const auto map = MapProjection::Of(
      "+proj=lcc +lat_1=30 +lat_2=60 +lat_0=38.5 +lon_0=-97.5 +R=6370000", middle);
  ASSERT_TRUE(map.ok()) << map.status();
  const PlaceTable table = MakePlaceTable(*map, middle, 5, 8.0);
  ASSERT_EQ(table.x_m.size(), 25U);
  ASSERT_EQ(table.y_m.size(), 25U);
  EXPECT_NEAR(table.x_m[12], 0.0F, 1e-3F);
  EXPECT_NEAR(table.y_m[12], 0.0F, 1e-3F);
  // The node in the first row and fourth column is 8 degrees south and 4 degrees east.
  const auto expected_m = map->WorldOf(PlaceAround(middle, glm::radians(4.0), glm::radians(-8.0)));
  ASSERT_TRUE(expected_m.has_value());
  EXPECT_NEAR(table.x_m[3], expected_m->x, 0.1);
  EXPECT_NEAR(table.y_m[3], expected_m->y, 0.1);
  EXPECT_GT(table.x_m[3], 300'000.0F);
  EXPECT_LT(table.y_m[3], -700'000.0F);
}

TEST(PlaceTableTest, HasNothingBeyondTheMap) {
  const EarthPlace middle{0.0, 60.0};
  const auto map = MapProjection::Of("+proj=geos +h=35785831 +lon_0=0 +sweep=y +R=6370000", middle);
  ASSERT_TRUE(map.ok()) << map.status();
  const PlaceTable table = MakePlaceTable(*map, middle, 5, 40.0);
  EXPECT_TRUE(std::isfinite(table.x_m[10]));  // 20 E
  EXPECT_TRUE(std::isnan(table.x_m[14]));     // 100 E is behind the Earth
  EXPECT_TRUE(std::isnan(table.y_m[14]));
}

}  // namespace
}  // namespace thunderhead::volume
