// Tests of the angles along the x and y axes of a CF file. They are longitudes and latitudes, those
// of a rotated grid, or the scanning angles of a satellite. Expected places are computed here with
// vectors, and distances with the haversine formula.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "tests/unit/storm_files/cf_file_test.h"

namespace thunderhead::storm_files {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using testing::Middles;
using ::testing::Not;
using testing::SyntheticCf;

constexpr double kRadian = M_PI / 180.0;

struct Place {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

// Returns the distance between two places on a sphere of 6371 km.
double Haversine_m(const Place& a, const Place& b) {
  const double north = std::sin(0.5 * kRadian * (b.latitude_deg - a.latitude_deg));
  const double east = std::sin(0.5 * kRadian * (b.longitude_deg - a.longitude_deg));
  return 2.0 * 6371000.0 *
         std::asin(std::sqrt(north * north + std::cos(kRadian * a.latitude_deg) *
                                                 std::cos(kRadian * b.latitude_deg) * east * east));
}

// Returns the place of coordinates on a rotated grid whose pole is at 43 N 170 W.
Place OnRotatedGrid(double longitude_deg, double latitude_deg) {
  const double l = kRadian * longitude_deg;
  const double p = kRadian * latitude_deg;
  const double pole = kRadian * 43.0;
  const double up = std::sin(p) * std::sin(pole) + std::cos(p) * std::cos(l) * std::cos(pole);
  const double along = std::sin(pole) * std::cos(p) * std::cos(l) - std::cos(pole) * std::sin(p);
  return {std::asin(up) / kRadian, 10.0 + std::atan2(std::cos(p) * std::sin(l), along) / kRadian};
}

// A satellite above the equator at 0 E, and the ellipsoid below it.
constexpr double kSatellite_m = 35785831.0;
constexpr double kEquator_m = 6378169.0;
constexpr double kPole_m = 6356583.8;

// Returns the place where the satellite's line of sight meets the ellipsoid. Its scanning angles
// are in radians. They sweep around the y axis as Meteosat's do, or around the x axis as those of
// GOES.
Place Seen(double x, double y, bool sweeps_x) {
  const double down = std::cos(x) * std::cos(y);
  const double east = sweeps_x ? std::sin(x) : std::cos(y) * std::sin(x);
  const double north = sweeps_x ? std::cos(x) * std::sin(y) : std::sin(y);
  const double from_m = kEquator_m + kSatellite_m;
  const double a =
      (down * down + east * east) / (kEquator_m * kEquator_m) + north * north / (kPole_m * kPole_m);
  const double b = -2.0 * from_m * down / (kEquator_m * kEquator_m);
  const double c = from_m * from_m / (kEquator_m * kEquator_m) - 1.0;
  const double way_m = (-b - std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
  const double axis_m = from_m - way_m * down;
  const double flat = kEquator_m * kEquator_m / (kPole_m * kPole_m);
  return {std::atan(way_m * north * flat / std::hypot(axis_m, way_m * east)) / kRadian,
          std::atan2(way_m * east, axis_m) / kRadian};
}

class CfAngles : public CfFileTest {
 protected:
  // Expects the middle of the domain within 0.001 degrees, and the distances between columns within
  // the relative `tolerance`.
  void ExpectPlace(const SyntheticCf& file, const Place& middle, double dx_m, double dy_m,
                   double tolerance = 1e-3) {
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_NEAR(info_.latitude_deg.value_or(NAN), middle.latitude_deg, 1e-3);
    EXPECT_NEAR(info_.longitude_deg.value_or(NAN), middle.longitude_deg, 1e-3);
    EXPECT_NEAR((*fields)->grid.spacing_m.x, dx_m, tolerance * dx_m);
    EXPECT_NEAR((*fields)->grid.spacing_m.y, dy_m, tolerance * dy_m);
  }

  // Expects no place on Earth, an assumption that says why, and the distances within 0.1 %.
  void ExpectNoPlace(const SyntheticCf& file, const std::string& why, double dx_m, double dy_m) {
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_FALSE(info_.latitude_deg.has_value());
    EXPECT_THAT(info_.assumptions, Contains(HasSubstr(why)));
    EXPECT_NEAR((*fields)->grid.spacing_m.x, dx_m, 1e-3 * dx_m);
    EXPECT_NEAR((*fields)->grid.spacing_m.y, dy_m, 1e-3 * dy_m);
  }
};

// Returns cloud water on 6 x 4 columns whose axes, x and y, have these middles, steps and units.
SyntheticCf OnAxes(double x, double y, double step, const std::string& units) {
  SyntheticCf file = testing::ExtinctionFile(6, 4, 4, 1000.0, 1000.0, 500.0, {});
  file.variables[0] = {
      "qc", {"z", "y", "x"}, {{"units", "kg m-3"}}, [](const Index&) { return 1e-4; }};
  file.coordinates[0] = {
      "x", Middles(6, x - 3.0 * step, step), {{"units", units}, {"axis", "X"}}, {}};
  file.coordinates[1] = {
      "y", Middles(4, y - 2.0 * step, step), {{"units", units}, {"axis", "Y"}}, {}};
  return file;
}

void Rename(SyntheticCf& file, const std::string& x, const std::string& y) {
  file.coordinates[0].name = x;
  file.coordinates[1].name = y;
  file.variables[0].dimensions = {"z", y, x};
}

void SetOnAxes(SyntheticCf& file, const std::string& attribute, const std::string& of_x,
               const std::string& of_y) {
  file.coordinates[0].attributes[attribute] = of_x;
  file.coordinates[1].attributes[attribute] = of_y;
}

void SetMapping(SyntheticCf& file, const Texts& texts,
                const std::map<std::string, double>& numbers) {
  file.variables.push_back({"crs", {}, texts, [](const Index&) { return 0.0; }});
  file.number_attributes["crs"] = numbers;
  file.variables[0].attributes["grid_mapping"] = "crs";
}

void AddSatellite(SyntheticCf& file, const std::string& sweep) {
  SetMapping(file, {{"grid_mapping_name", "geostationary"}, {"sweep_angle_axis", sweep}},
             {{"perspective_point_height", kSatellite_m},
              {"longitude_of_projection_origin", 0.0},
              {"semi_major_axis", kEquator_m},
              {"semi_minor_axis", kPole_m}});
}

// Adds the latitude and longitude of each column, from the coordinates of its axes.
void SetPlaces(SyntheticCf& file, const std::function<Place(double x, double y)>& place_of) {
  const std::string x = file.coordinates[0].name;
  const std::string y = file.coordinates[1].name;
  const auto at = [=, xs = file.coordinates[0].values, ys = file.coordinates[1].values](
                      const Index& index) { return place_of(xs[index.at(x)], ys[index.at(y)]); };
  file.variables.push_back({"latitudes",
                            {y, x},
                            {{"units", "degrees_north"}, {"standard_name", "latitude"}},
                            [at](const Index& index) { return at(index).latitude_deg; }});
  file.variables.push_back({"longitudes",
                            {y, x},
                            {{"units", "degrees_east"}, {"standard_name", "longitude"}},
                            [at](const Index& index) { return at(index).longitude_deg; }});
  file.variables[0].attributes["coordinates"] = "latitudes longitudes";
}

// Longitudes and latitudes of the columns decide, because plain degrees may be those of any grid.
TEST_F(CfAngles, PlainDegreesAreOfTheEarthOnlyIfTheySaySo) {
  SyntheticCf rotated = OnAxes(-2.0, -3.0, 0.02, "degrees");
  const double dx_m = Haversine_m(OnRotatedGrid(-2.01, -3.0), OnRotatedGrid(-1.99, -3.0));
  const double dy_m = Haversine_m(OnRotatedGrid(-2.0, -3.01), OnRotatedGrid(-2.0, -2.99));
  ExpectNoPlace(rotated, "do not say that they are longitudes and latitudes", dx_m, dy_m);
  SetPlaces(rotated, OnRotatedGrid);
  ExpectPlace(rotated, OnRotatedGrid(-2.0, -3.0), dx_m, dy_m);
  EXPECT_THAT(info_.assumptions, Each(Not(HasSubstr("place"))));
}

TEST_F(CfAngles, DegreesOfTheEarthAreKnownByNamesUnitsOrMapping) {
  const SyntheticCf plain = OnAxes(8.0, 47.0, 0.01, "degrees");
  const double dx_m = Haversine_m({47.0, 7.995}, {47.0, 8.005});
  const double dy_m = Haversine_m({46.995, 8.0}, {47.005, 8.0});
  const std::vector<std::function<void(SyntheticCf&)>> signs = {
      [](SyntheticCf& file) { SetOnAxes(file, "standard_name", "longitude", "latitude"); },
      [](SyntheticCf& file) { SetOnAxes(file, "units", "degrees_east", "degrees_north"); },
      [](SyntheticCf& file) { SetOnAxes(file, "units", "degree_E", "degree_N"); },
      [](SyntheticCf& file) { SetOnAxes(file, "long_name", "Longitude", "Latitude"); },
      [](SyntheticCf& file) { Rename(file, "lon", "lat"); },
      [](SyntheticCf& file) { Rename(file, "lon_2", "lat_2"); },
      [](SyntheticCf& file) {
        SetMapping(file, {{"grid_mapping_name", "latitude_longitude"}},
                   {{"earth_radius", 6371000.0}});
      },
  };
  for (const auto& sign : signs) {
    SyntheticCf file = plain;
    sign(file);
    ExpectPlace(file, {47.0, 8.0}, dx_m, dy_m);
  }
  SyntheticCf radians = OnAxes(8.0 * kRadian, 47.0 * kRadian, 0.01 * kRadian, "radian");
  SetOnAxes(radians, "standard_name", "longitude", "latitude");
  ExpectPlace(radians, {47.0, 8.0}, dx_m, dy_m);
}

// Axes that look like longitudes and latitudes may be those of a rotated grid. The places of all
// columns show it.
TEST_F(CfAngles, PlacesOfAllColumnsWinAgainstAxesThatDisagree) {
  SyntheticCf file = OnAxes(-2.0, -3.0, 0.02, "degrees");
  Rename(file, "lon", "lat");
  SetPlaces(file, OnRotatedGrid);
  ExpectPlace(file, OnRotatedGrid(-2.0, -3.0),
              Haversine_m(OnRotatedGrid(-2.01, -3.0), OnRotatedGrid(-1.99, -3.0)),
              Haversine_m(OnRotatedGrid(-2.0, -3.01), OnRotatedGrid(-2.0, -2.99)));
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("the coordinates lon and lat put columns up")));
  // Places that agree say nothing, and places with missing values are left out.
  for (const double last_deg : {47.015, std::nan("")}) {
    file = OnAxes(8.0, 47.0, 0.01, "degrees");
    Rename(file, "lon", "lat");
    SetPlaces(file, [=](double x, double y) { return Place{y > 47.01 ? last_deg : y, x}; });
    ExpectPlace(file, {47.0, 8.0}, Haversine_m({47.0, 7.995}, {47.0, 8.005}),
                Haversine_m({46.995, 8.0}, {47.005, 8.0}));
    EXPECT_EQ(::testing::Matches(Contains(HasSubstr("cannot be used")))(info_.assumptions),
              std::isnan(last_deg));
    EXPECT_THAT(info_.assumptions, Each(Not(HasSubstr("put columns"))));
  }
}

// Scanning angles of 84 microradians, 3 km below the satellite, are 3.2 km x 5.4 km here. The
// haversine formula is within 0.5 % of the ellipsoid. East of the satellite the axes are turned
// against north, and the even columns with north up mix the distances along both axes.
TEST_F(CfAngles, ScanningAnglesGoThroughTheSatellitesMapping) {
  constexpr double kY = 0.12;
  constexpr double kHalf = 4.2e-5;
  for (const auto& [at_x, tolerance, sweeps_x] :
       {std::tuple{0.0, 0.005, false}, {0.02, 0.02, false}, {0.02, 0.02, true}}) {
    const auto seen = [sweeps_x = sweeps_x](double x, double y) { return Seen(x, y, sweeps_x); };
    const double dx_m = Haversine_m(seen(at_x - kHalf, kY), seen(at_x + kHalf, kY));
    const double dy_m = Haversine_m(seen(at_x, kY - kHalf), seen(at_x, kY + kHalf));
    for (const auto& [units, unit] :
         {std::pair{"rad", 1.0}, {"radian", 1.0}, {"radians", 1.0}, {"degrees", kRadian}}) {
      for (const std::string name : {"", "coordinate", "angular_coordinate"}) {
        SCOPED_TRACE(absl::StrCat(units, " ", name, " ", at_x, sweeps_x ? " x" : " y"));
        SyntheticCf file = OnAxes(at_x / unit, kY / unit, 2.0 * kHalf / unit, units);
        if (!name.empty()) {
          SetOnAxes(file, "standard_name", "projection_x_" + name, "projection_y_" + name);
        }
        AddSatellite(file, sweeps_x ? "x" : "y");
        ExpectPlace(file, seen(at_x, kY), dx_m, dy_m, tolerance);
        // Longitudes and latitudes of all columns agree, so nothing is said about them.
        SetPlaces(file, [=, unit = unit](double x, double y) { return seen(x * unit, y * unit); });
        ExpectPlace(file, seen(at_x, kY), dx_m, dy_m, tolerance);
        EXPECT_THAT(info_.assumptions, Each(Not(HasSubstr("put columns"))));
      }
    }
  }
}

TEST_F(CfAngles, PlacesOfAllColumnsWinAgainstASatellitesMapping) {
  SyntheticCf file = OnAxes(0.02, 0.12, 8.4e-5, "rad");
  AddSatellite(file, "y");
  SetPlaces(file, [](double x, double y) {
    Place place = Seen(x, y, false);
    place.latitude_deg -= 0.1;
    return place;
  });
  ASSERT_TRUE(Read(file).ok());
  EXPECT_NEAR(info_.latitude_deg.value(), Seen(0.02, 0.12, false).latitude_deg - 0.1, 1e-3);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("grid mapping crs put columns up to 11.1")));
}

TEST_F(CfAngles, AnglesWithoutALengthAreRefused) {
  ExpectError(OnAxes(0.02, 0.12, 8.4e-5, "radian"),
              "x and y are angles in 'radian', and neither their names nor a grid mapping say");
  SyntheticCf file = OnAxes(1.0, 6.0, 0.005, "degrees");
  SetOnAxes(file, "standard_name", "projection_x_angular_coordinate",
            "projection_y_angular_coordinate");
  ExpectError(file, "add the satellite's grid_mapping");
}

// A mapping of lengths does not place degrees, nor one of degrees lengths.
TEST_F(CfAngles, AMappingNeedsCoordinatesOfItsKind) {
  SyntheticCf file = OnAxes(8.0, 47.0, 0.01, "degrees");
  SetMapping(file, {{"grid_mapping_name", "mercator"}},
             {{"standard_parallel", 0.0}, {"longitude_of_projection_origin", 8.0}});
  ExpectError(file,
              "the grid mapping crs needs coordinates in m or km, and the units of x are "
              "'degrees'");
  file = OnAxes(8.0, 47.0, 1000.0, "m");
  SetMapping(file, {{"grid_mapping_name", "latitude_longitude"}}, {{"earth_radius", 6371000.0}});
  ExpectNoPlace(file, "crs is one of longitudes and latitudes, so it does not place x and y",
                1000.0, 1000.0);
  file = OnAxes(8.0, 47.0, 1000.0, "m");
  SetMapping(file, {{"grid_mapping_name", "rotated_latitude_longitude"}},
             {{"grid_north_pole_latitude", 43.0}, {"grid_north_pole_longitude", -170.0}});
  ExpectError(file,
              "the grid mapping crs needs coordinates in degrees, and the units of x are 'm'");
}

}  // namespace
}  // namespace thunderhead::storm_files
