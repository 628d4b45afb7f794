// Tests of columns that are even in true metres. Places come from formulas, and not from PROJ. True
// distances are great circles.
#include "storm_files/even_columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <utility>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "storm_files/resampled_columns.h"
#include "tests/support/earth_formulas.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {
namespace {

using testing::Distance_m;
using ::testing::ElementsAre;
using testing::FromMercator;
using testing::FromPolar;
using testing::FromRotated;
using testing::FromStereographic;
using ::testing::HasSubstr;
using testing::kEarth_m;
using testing::LambertFormulas;
using volume::EarthPlace;

// A model's grid, with the place of each column by this file's formulas.
struct Model {
  ColumnPlaces places;
  std::function<EarthPlace(const glm::dvec2& position)> place_of;

  EarthPlace At(double x, double y) const { return place_of({x, y}); }
};

Model ProjectedGrid(const std::string& projection, const glm::ivec2& columns,
                    const glm::dvec2& first, const glm::dvec2& step,
                    std::function<EarthPlace(const glm::dvec2&)> inverse) {
  Model model;
  model.places.columns = columns;
  model.places.projection = projection;
  model.places.first = first;
  model.places.step = step;
  model.place_of = [=, inverse = std::move(inverse)](const glm::dvec2& position) {
    return inverse(first + position * step);
  };
  return model;
}

// Returns the same columns with their places one by one.
Model Listed(Model model) {
  model.places.projection.clear();
  model.places.radius_m = kEarth_m;
  for (int y = 0; y < model.places.columns.y; ++y) {
    for (int x = 0; x < model.places.columns.x; ++x) {
      const EarthPlace place = model.At(x, y);
      model.places.latitude_deg.push_back(static_cast<float>(place.latitude_deg));
      model.places.longitude_deg.push_back(
          static_cast<float>(std::remainder(place.longitude_deg, 360.0)));
    }
  }
  return model;
}

const LambertFormulas kLambert(30.0, 60.0, -97.0);

Model LambertGrid(const glm::ivec2& columns, double step_m, const glm::dvec2& first_m) {
  // The plane's origin is the tip of the cone here, and lat_0 in PROJ. With lat_0 at the pole both
  // are the same.
  return ProjectedGrid("+proj=lcc +lat_1=30 +lat_2=60 +lat_0=90 +lon_0=-97 +R=6370000", columns,
                       first_m, glm::dvec2(step_m),
                       [](const glm::dvec2& at) { return kLambert.PlaceOf(at); });
}

Model MercatorGrid(double meridian_deg) {
  return ProjectedGrid(
      "+proj=merc +lat_ts=0 +lon_0=" + std::to_string(meridian_deg) + " +R=6370000", {48, 48},
      {-290e3, 2.49e6}, {1e4, 1e4},
      [=](const glm::dvec2& at) { return FromMercator(at, 0.0, meridian_deg); });
}

Model PolarGrid() {
  // The grid's y axis points 50 degrees to the west of north.
  return ProjectedGrid("+proj=stere +lat_0=90 +lat_ts=60 +lon_0=-45 +R=6370000", {80, 60},
                       {1.5e6, -1.6e6}, {8e3, 8e3},
                       [](const glm::dvec2& at) { return FromPolar(at, 60.0, -45.0); });
}

Model LongitudeLatitudeGrid(double first_lon_deg, double first_lat_deg) {
  return ProjectedGrid("+proj=longlat +R=6370000", {120, 70}, {first_lon_deg, first_lat_deg},
                       {0.1, 0.1}, [](const glm::dvec2& at) {
                         return EarthPlace{at.y, at.x};
                       });
}

Model RotatedGrid() {
  // COSMO's pole over Germany: 40 N 170 W.
  return ProjectedGrid("+proj=ob_tran +o_proj=longlat +o_lat_p=40 +o_lon_p=0 +lon_0=10 +R=6370000",
                       {90, 90}, {2.0, -12.0}, {0.12, 0.12}, [](const glm::dvec2& at) {
                         return FromRotated(at, {40.0, -170.0});
                       });
}

EarthPlace PlaceOfEven(const EvenColumns& even, double x, double y) {
  const glm::dvec2 offset = glm::dvec2(x, y) - 0.5 * glm::dvec2(even.columns - 1);
  return FromStereographic(offset * glm::dvec2(even.dx_m, even.dy_m), even.middle);
}

// Checks resampled columns against the model's places.
void ExpectEven(const Model& model, const EvenColumns& even) {
  ASSERT_TRUE(even.Resampled());
  EXPECT_THAT(even.projection, HasSubstr("+proj=stere"));
  const EarthPlace middle = model.place_of(0.5 * glm::dvec2(model.places.columns - 1));
  EXPECT_LT(Distance_m(even.middle, middle), 2.0);
  ASSERT_EQ(even.from.size(), static_cast<std::size_t>(even.columns.x * even.columns.y));
  const int width = model.places.columns.x;
  int inside = 0;
  for (int y = 0; y < even.columns.y; ++y) {
    for (int x = 0; x < even.columns.x; ++x) {
      const FromColumn& from = even.from[static_cast<std::size_t>(y * even.columns.x + x)];
      if (!from.inside) continue;
      ++inside;
      const EarthPlace here = PlaceOfEven(even, x, y);
      const double to_east_m = Distance_m(here, PlaceOfEven(even, x + 1, y));
      const double to_north_m = Distance_m(here, PlaceOfEven(even, x, y + 1));
      ASSERT_NEAR(to_east_m / even.dx_m, 1.0, even.largest_error + 1e-4);
      ASSERT_NEAR(to_north_m / even.dy_m, 1.0, even.largest_error + 1e-4);
      const auto south_west = static_cast<int>(from.south_west);
      const glm::ivec2 column(south_west % width, south_west / width);
      const glm::dvec2 position(column.x + from.east, column.y + from.north);
      // Even columns in the outer half of one of the model's outermost columns get the values of
      // its centre, so their places are not compared.
      const glm::dvec2 edge = glm::dvec2(model.places.columns - 1) - 1e-3;
      if (position.x < 1e-3 || position.y < 1e-3 || position.x > edge.x || position.y > edge.y) {
        continue;
      }
      ASSERT_LT(Distance_m(here, model.place_of(position)), 0.01 * even.dx_m) << x << ", " << y;
    }
  }
  // The even columns inside cover the area of the model's columns.
  double area_m2 = 0.0;
  for (int y = 0; y < model.places.columns.y; ++y) {
    for (int x = 0; x < width; ++x) {
      area_m2 += Distance_m(model.At(x - 0.5, y), model.At(x + 0.5, y)) *
                 Distance_m(model.At(x, y - 0.5), model.At(x, y + 0.5));
    }
  }
  EXPECT_NEAR(inside * even.dx_m * even.dy_m / area_m2, 1.0, 0.01 + 2.0 * even.largest_error);
  EXPECT_LE(even.columns.x * even.columns.y, 2 * width * model.places.columns.y);
}

// Returns the mean true distance between the model's columns along x, as the test computes it.
double MeanAlongX_m(const Model& model) {
  double sum_m = 0.0;
  const glm::ivec2 columns = model.places.columns;
  for (int y = 0; y < columns.y; ++y) {
    for (int x = 0; x + 1 < columns.x; ++x) {
      sum_m += Distance_m(model.At(x, y), model.At(x + 1, y));
    }
  }
  return sum_m / (columns.y * (columns.x - 1));
}

TEST(EvenColumns, ResamplesEachKindOfGridToTrueDistances) {
  const std::vector<std::pair<std::string, Model>> models = {
      {"Lambert", LambertGrid({300, 200}, 6e3, {-700e3, -7.4e6})},
      {"Mercator", MercatorGrid(-89.0)},
      {"Mercator over the date line", MercatorGrid(179.5)},
      {"polar stereographic", PolarGrid()},
      {"60 N", LongitudeLatitudeGrid(4.0, 57.0)},
      {"Greenwich", LongitudeLatitudeGrid(354.0, 50.0)},
      {"date line", LongitudeLatitudeGrid(174.0, -63.0)},
      {"rotated pole", RotatedGrid()},
  };
  for (const auto& [name, projected] : models) {
    for (const Model& model : {projected, Listed(projected)}) {
      SCOPED_TRACE(name + (model.places.projection.empty() ? ", listed" : ""));
      const auto even = MakeEven(model.places);
      ASSERT_TRUE(even.ok()) << even.status();
      ExpectEven(model, *even);
      EXPECT_NEAR(even->mean_m.x / MeanAlongX_m(model), 1.0, 1e-3);
      EXPECT_LT(even->largest_error, 0.01);
    }
  }
}

TEST(EvenColumns, SaysWhatWasDone) {
  const auto even = MakeEven(MercatorGrid(-89.0).places);
  ASSERT_TRUE(even.ok()) << even.status();
  const Model model = MercatorGrid(-89.0);
  // The distances along x and along y are equal in a Mercator projection, which is conformal.
  EXPECT_NEAR(even->dx_m, MeanAlongX_m(model), 1.0);
  EXPECT_NEAR(even->shortest_m.x, Distance_m(model.At(0.0, 47.0), model.At(1.0, 47.0)), 0.1);
  EXPECT_NEAR(even->longest_m.x, Distance_m(model.At(0.0, 0.0), model.At(1.0, 0.0)), 0.1);
  EXPECT_THAT(AssumptionsOf(*even),
              ElementsAre(::testing::MatchesRegex(
                  "The columns were resampled to even distances of 91.. m, because the true "
                  "distances between the model's columns are 90.. to 92.. m.")));
  const auto degrees = MakeEven(LongitudeLatitudeGrid(4.0, 57.0).places);
  ASSERT_TRUE(degrees.ok()) << degrees.status();
  EXPECT_THAT(AssumptionsOf(*degrees),
              ElementsAre(HasSubstr(" m along x and 11118 to 11118 m along y.")));
}

// One domain is at the latitude where the projection's scale is true. In the others the map factor
// hardly varies. It is about 0.97 at 45 N and 1.06 at 20 N.
TEST(EvenColumns, KeepsColumnsThatAreEvenAlready) {
  for (const double latitude_deg : {30.0, 45.0, 20.0}) {
    const double tip_m = kLambert.FromTip_m(latitude_deg);
    const Model model =
        LambertGrid({60, 50}, 1000.0, {-429.5e3, -std::sqrt(tip_m * tip_m - 16e10) - 24.5e3});
    const auto even = MakeEven(model.places);
    ASSERT_TRUE(even.ok()) << even.status();
    EXPECT_FALSE(even->Resampled());
    EXPECT_EQ(even->columns, glm::ivec2(60, 50));
    const double true_m = Distance_m(model.At(29.0, 25.0), model.At(30.0, 25.0));
    EXPECT_NEAR(1000.0 / true_m, kLambert.Scale(latitude_deg), 0.001);
    EXPECT_NEAR(even->dx_m / true_m, 1.0, 0.003);
    EXPECT_LT(even->largest_error, 0.005);
    EXPECT_THAT(even->projection, HasSubstr("+proj=lcc"));
    EXPECT_THAT(AssumptionsOf(*even), ::testing::IsEmpty());
    // Metres in the plane of its projection are true, and the columns are where the model has them.
    const auto map = volume::MapProjection::Of(even->projection, even->middle);
    ASSERT_TRUE(map.ok()) << map.status();
    for (const glm::dvec2& at : {glm::dvec2(0, 0), glm::dvec2(59, 0), glm::dvec2(20, 49)}) {
      const glm::dvec2 world_m = (at - glm::dvec2(29.5, 24.5)) * glm::dvec2(even->dx_m, even->dy_m);
      const auto place = map->PlaceOf(world_m);
      ASSERT_TRUE(place.has_value());
      EXPECT_LT(Distance_m(*place, model.place_of(at)), 1.0);
    }
  }
}

TEST(EvenColumns, KeepsASmallLongitudeLatitudeGrid) {
  Model model = LongitudeLatitudeGrid(10.0, 60.0);
  model.places.columns = {40, 10};
  model.places.step = {0.01, 0.005};
  const auto even = MakeEven(model.places);
  ASSERT_TRUE(even.ok()) << even.status();
  EXPECT_FALSE(even->Resampled());
  EXPECT_NEAR(even->dx_m, glm::radians(0.01) * kEarth_m * std::cos(glm::radians(60.0225)), 0.5);
  EXPECT_NEAR(even->dy_m, glm::radians(0.005) * kEarth_m, 0.1);
  EXPECT_THAT(even->projection, HasSubstr("+proj=eqc"));
}

// The columns of a turned grid are even, but its axes do not point east and north, so the columns
// are resampled to axes that do.
TEST(EvenColumns, TurnsListedColumnsNorthUp) {
  const EarthPlace middle{40.0, 5.0};
  Model turned;
  turned.places.columns = {40, 40};
  turned.place_of = [=](const glm::dvec2& position) {
    const glm::dvec2 offset_m = 2000.0 * (position - 19.5);
    return FromStereographic(
        glm::dvec2(0.8 * offset_m.x - 0.6 * offset_m.y, 0.6 * offset_m.x + 0.8 * offset_m.y),
        middle);
  };
  turned = Listed(turned);
  const auto even = MakeEven(turned.places);
  ASSERT_TRUE(even.ok()) << even.status();
  ExpectEven(turned, *even);
  EXPECT_NEAR(even->grid_north_rad, std::atan2(0.6, 0.8), 1e-3);
  const glm::dvec2 north = AlongEvenAxes(*even, {0.0, 10.0});
  EXPECT_NEAR(north.x, -6.0, 0.01);
  EXPECT_NEAR(north.y, 8.0, 0.01);
  EXPECT_EQ(EastNorthAlongEvenAxes(*even, {3.0, 4.0}), glm::dvec2(3.0, 4.0));
}

// Returns the least and the largest scale of a map, which is a length on it divided by the true
// length. The lengths are steps of 0.01 columns from 40 x 40 places all over the model's domain.
std::pair<double, double> ScalesOn(const std::string& projection, const Model& model) {
  const auto map = volume::MapProjection::Open(projection);
  EXPECT_TRUE(map.ok()) << map.status();
  std::pair<double, double> scales(1.0, 1.0);
  constexpr int kSteps = 40;
  for (int k = 0; k < kSteps * kSteps; ++k) {
    const glm::dvec2 at =
        glm::dvec2(model.places.columns - 1) * glm::dvec2(k % kSteps, k / kSteps) / (kSteps - 1.0);
    for (const glm::dvec2 step : {glm::dvec2(0.01, 0), glm::dvec2(0, 0.01)}) {
      const EarthPlace from = model.place_of(at);
      const EarthPlace to = model.place_of(at + step);
      const double scale =
          glm::distance(*map->WorldOf(from), *map->WorldOf(to)) / Distance_m(from, to);
      scales = {std::min(scales.first, scale), std::max(scales.second, scale)};
    }
  }
  return scales;
}

void ExpectStatedErrors(const EvenColumns& even, const Model& model) {
  const auto [least, largest] = ScalesOn(even.projection, model);
  EXPECT_TRUE(even.IsTooWide());
  // The stated scales hold up to the edges of the outermost columns, beyond the centres that
  // ScalesOn uses.
  EXPECT_LT(even.least_scale, least + 1e-4);
  EXPECT_GT(even.largest_scale, largest - 1e-3);
  EXPECT_NEAR(even.least_scale, least, 0.005);
  EXPECT_NEAR(even.largest_scale, largest, 0.005);
  EXPECT_EQ(even.largest_error, std::max(1.0 - even.least_scale, even.largest_scale - 1.0));
  const auto map = volume::MapProjection::Open(even.projection);
  EarthPlace north = even.middle;
  north.latitude_deg += 0.1;
  EXPECT_NEAR(glm::distance(*map->WorldOf(even.middle), *map->WorldOf(north)) /
                  Distance_m(even.middle, north),
              1.0, 2e-3);
  const std::vector<std::string> sentences = AssumptionsOf(even);
  ASSERT_FALSE(sentences.empty());
  EXPECT_THAT(sentences.back(), HasSubstr("true in the middle, and "));
}

// The columns of a continent stay on the model's map, if that is conformal.
TEST(EvenColumns, KeepsAWideDomainOnItsConformalMap) {
  Model polar = PolarGrid();
  polar.places.step = {6e4, 6e4};
  polar.place_of = [first = polar.places.first](const glm::dvec2& at) {
    return FromPolar(first + at * 6e4, 60.0, -45.0);
  };
  for (const Model& model : {LambertGrid({400, 300}, 12e3, {-2.4e6, -8.6e6}), polar}) {
    const auto even = MakeEven(model.places);
    ASSERT_TRUE(even.ok()) << even.status();
    EXPECT_FALSE(even->Resampled());
    ExpectStatedErrors(*even, model);
    EXPECT_THAT(AssumptionsOf(*even), ElementsAre(HasSubstr("The domain reaches ")));
    // The map gives every column its place.
    const auto map = volume::MapProjection::Of(even->projection, even->middle);
    const glm::dvec2 last(model.places.columns - 1);
    for (const glm::dvec2 share : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(0.3, 1)}) {
      const glm::dvec2 world_m = (share - 0.5) * last * glm::dvec2(even->dx_m, even->dy_m);
      EXPECT_LT(Distance_m(*map->PlaceOf(world_m), model.place_of(share * last)), 50.0);
    }
  }
}

// The columns of a continent without a map, or on a map that distorts much, are resampled to a map
// with smaller errors.
TEST(EvenColumns, ResamplesAWideDomainToAConformalMap) {
  Model degrees = LongitudeLatitudeGrid(-30.0, 25.0);
  degrees.places.step = {0.6, 0.6};
  degrees.place_of = [](const glm::dvec2& at) {
    return EarthPlace{25.0 + 0.6 * at.y, -30.0 + 0.6 * at.x};
  };
  // From the equator to 66 N, Mercator's scale doubles.
  Model mercator =
      ProjectedGrid("+proj=merc +lat_ts=0 +lon_0=10 +R=6370000", {100, 100}, {-4e6, 0.0},
                    {8e4, 1e5}, [](const glm::dvec2& at) { return FromMercator(at, 0.0, 10.0); });
  Model turned = RotatedGrid();
  turned.places.step = {0.4, 0.4};
  turned.place_of = [](const glm::dvec2& at) {
    return FromRotated(glm::dvec2(2.0, -12.0) + 0.4 * at, {40.0, -170.0});
  };
  const Model lambert = Listed(LambertGrid({200, 150}, 24e3, {-2.4e6, -8.6e6}));
  for (const Model& model : {degrees, Listed(degrees), mercator, turned, lambert}) {
    const auto even = MakeEven(model.places);
    ASSERT_TRUE(even.ok()) << even.status();
    ASSERT_TRUE(even->Resampled());
    ExpectStatedErrors(*even, model);
    EXPECT_LT(even->largest_error, 0.25);
    const auto map = volume::MapProjection::Of(even->projection, even->middle);
    ASSERT_TRUE(map.ok()) << map.status();
    for (int y = 0; y < even->columns.y; y += 3) {
      for (int x = 0; x < even->columns.x; x += 3) {
        const FromColumn& from = even->from[static_cast<std::size_t>(y * even->columns.x + x)];
        if (!from.inside) continue;
        const int width = model.places.columns.x;
        const auto south_west = static_cast<int>(from.south_west);
        const glm::ivec2 column(south_west % width, south_west / width);
        const glm::dvec2 position(column.x + from.east, column.y + from.north);
        const glm::dvec2 edge = glm::dvec2(model.places.columns - 1) - 1e-3;
        if (position.x < 1e-3 || position.y < 1e-3 || position.x > edge.x || position.y > edge.y) {
          continue;
        }
        const glm::dvec2 world_m = (glm::dvec2(x, y) - 0.5 * glm::dvec2(even->columns - 1)) *
                                   glm::dvec2(even->dx_m, even->dy_m);
        ASSERT_LT(Distance_m(*map->PlaceOf(world_m), model.place_of(position)), 0.1 * even->dx_m)
            << x << ", " << y;
      }
    }
  }
}

// The whole Earth has no conformal map. Its columns stay, and the error at the poles is stated.
TEST(EvenColumns, StatesTheErrorsOfTheWholeEarth) {
  Model earth = LongitudeLatitudeGrid(0.0, -90.0);
  earth.places.columns = {144, 73};
  earth.places.step = {2.5, 2.5};
  const auto even = MakeEven(earth.places);
  ASSERT_TRUE(even.ok()) << even.status();
  EXPECT_FALSE(even->Resampled());
  EXPECT_EQ(even->columns, glm::ivec2(144, 73));
  EXPECT_THAT(AssumptionsOf(*even), ElementsAre(HasSubstr("more than 1000 % of the true ones")));
  earth.place_of = [](const glm::dvec2& at) { return EarthPlace{-90.0 + 2.5 * at.y, 2.5 * at.x}; };
  EXPECT_THAT(std::string(MakeEven(Listed(earth).places).status().message()),
              HasSubstr("no flat map of it is of use; cut a region of at most 10006 km"));
}

// The scale of an oblique map is a factor, and not a latitude.
TEST(EvenColumns, ScalesAnObliqueMap) {
  const EarthPlace centre{47.0, 8.0};
  const Model model = ProjectedGrid(
      "+proj=stere +lat_0=47 +lon_0=8 +k_0=0.9 +R=6370000", {300, 280}, {-1.2e6, -1.4e6},
      {9e3, 9e3}, [=](const glm::dvec2& at) { return FromStereographic(at / 0.9, centre); });
  const auto even = MakeEven(model.places);
  ASSERT_TRUE(even.ok()) << even.status();
  EXPECT_NEAR(even->dx_m, 1e4, 250.0);
  EXPECT_THAT(even->projection, HasSubstr("+proj=stere"));
  const auto map = volume::MapProjection::Of(even->projection, even->middle);
  const auto to_m = map->WorldOf(model.place_of({150.0, 140.0}));
  const auto from_m = map->WorldOf(model.place_of({149.0, 140.0}));
  EXPECT_NEAR(glm::distance(*from_m, *to_m) /
                  Distance_m(model.place_of({149.0, 140.0}), model.place_of({150.0, 140.0})),
              1.0, 2e-3);
}

TEST(EvenColumns, RefusesWhatIsUnusable) {
  const auto refusal = [](const ColumnPlaces& places) {
    return std::string(MakeEven(places).status().message());
  };
  ColumnPlaces missing = Listed(MercatorGrid(0.0)).places;
  missing.latitude_deg[48 * 2 + 5] = std::nanf("");
  EXPECT_THAT(refusal(missing), HasSubstr("column (5, 2)"));
  ColumnPlaces same = Listed(MercatorGrid(0.0)).places;
  std::ranges::fill(same.latitude_deg, 10.0F);
  std::ranges::fill(same.longitude_deg, 10.0F);
  EXPECT_THAT(refusal(same), HasSubstr("at the same place"));
  ColumnPlaces one = same;
  one.columns = {1, 48 * 48};
  EXPECT_THAT(refusal(one), HasSubstr("only one along an axis"));
  ColumnPlaces backwards = MercatorGrid(0.0).places;
  backwards.step.y = -1e4;
  EXPECT_THAT(refusal(backwards), HasSubstr("not above 0"));
  ColumnPlaces unknown = MercatorGrid(0.0).places;
  unknown.projection = "+proj=nothing +R=6370000";
  EXPECT_THAT(refusal(unknown), HasSubstr("a projection that storms can have"));
  unknown.projection = "+proj=merc";
  EXPECT_THAT(refusal(unknown), HasSubstr("size of the Earth"));

  // A few bytes of a file can announce many columns.
  ColumnPlaces huge = LongitudeLatitudeGrid(4.0, 57.0).places;
  huge.columns = {1'000'000, 900'000};
  huge.step = {1e-5, 1e-5};
  EXPECT_EQ(MakeEven(huge).status().code(), absl::StatusCode::kResourceExhausted);

  // Places in any order are no grid, and are refused in a short time.
  ColumnPlaces scattered = Listed(MercatorGrid(0.0)).places;
  std::mt19937 random(1);
  for (std::size_t i = 0; i < scattered.latitude_deg.size(); ++i) {
    scattered.latitude_deg[i] = 20.0F + static_cast<float>(random() % 1000) / 200.0F;
    scattered.longitude_deg[i] = static_cast<float>(random() % 1000) / 200.0F;
  }
  EXPECT_THAT(refusal(scattered), HasSubstr("do not form a grid"));
}

// Another time of a domain that moves gets as many columns, at its own true distances.
TEST(EvenColumns, FollowsADomainThatMoves) {
  const Model first = MercatorGrid(-89.0);
  const auto even = MakeEven(first.places);
  ASSERT_TRUE(even.ok()) << even.status();
  Model later = first;
  later.places.first += glm::dvec2(-150e3, 1000e3);
  const auto moved = MakeEven(later.places, {.columns = even->columns});
  ASSERT_TRUE(moved.ok()) << moved.status();
  EXPECT_EQ(moved->columns, even->columns);
  EXPECT_NEAR(moved->dx_m, moved->mean_m.x, 0.01 * moved->dx_m);
  EXPECT_NEAR(moved->dy_m, moved->mean_m.y, 0.01 * moved->dy_m);
  EXPECT_LT(moved->dx_m, 0.95 * even->dx_m);
  EXPECT_NE(moved->projection, even->projection);
  EXPECT_EQ(*ProjectionOfEven(later.places, {.columns = even->columns}), moved->projection);
  const EarthPlace middle = FromMercator(later.places.first + 23.5 * later.places.step, 0.0, -89.0);
  EXPECT_LT(Distance_m(moved->middle, middle), 2.0);
  // The column in the middle of the even grid is the one in the middle of the model's.
  const FromColumn& from = moved->from[static_cast<std::size_t>(
      (moved->columns.y / 2) * moved->columns.x + moved->columns.x / 2)];
  const double middle_column = from.south_west % 48 + static_cast<double>(from.east);
  EXPECT_NEAR(middle_column, 23.5, 0.6);
  EXPECT_NE(moved->model_areas, even->model_areas);
}

}  // namespace
}  // namespace thunderhead::storm_files
