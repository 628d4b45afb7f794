// Tests of the places in GeoTIFF files. GDAL's own program reads the files and says where their
// corner is.
#include "product/geotiff.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "glm/trigonometric.hpp"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/temporary_folder.h"
#include "volume/map_projection.h"

namespace thunderhead::product {
namespace {

// Returns a file of 10 by 8 pixels, whose upper left corner is at `place`.
absl::StatusOr<std::string> TiffAt(const std::string& proj, const volume::EarthPlace& place) {
  const auto map = volume::MapProjection::Open(proj);
  EXPECT_TRUE(map.ok()) << map.status();
  frame::RgbImage image;
  image.width_px = 10;
  image.height_px = 8;
  image.rgb.assign(240, 100);
  return EncodeGeoTiff(image,
                       {.projection = proj,
                        .upper_left_m = map->WorldOf(place).value_or(glm::dvec2(0.0)),
                        .pixel_m = glm::dvec2(1000.0)},
                       {});
}

// Returns the place of the file's corner by GDAL, in degrees on the same figure of the Earth.
volume::EarthPlace CornerOf(const std::string& path, const std::string& earth) {
  const std::string command = absl::StrCat("echo 0 0 | gdaltransform -t_srs '+proj=longlat ", earth,
                                           " +no_defs' ", path, " 2>&1");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> answer(popen(command.c_str(), "r"), pclose);
  volume::EarthPlace place{1000.0, 1000.0};
  if (answer == nullptr ||
      std::fscanf(answer.get(), "%lf %lf", &place.longitude_deg, &place.latitude_deg) != 2) {
    ADD_FAILURE() << "gdaltransform cannot read " << path << "; it is in Debian's gdal-bin";
  }
  return place;
}

struct Grid {
  const char* proj;
  const char* earth;
};

TEST(GeoTiff, IsAtItsPlaceInEveryProjection) {
  const testing::TemporaryFolder folder;
  const volume::EarthPlace place{48.0, 9.0};
  for (const Grid& grid :
       {Grid{"+proj=lcc +lat_1=30 +lat_2=60 +lat_0=38.5 +lon_0=10", "+R=6370000"},
        Grid{"+proj=lcc +lat_1=38.5 +lat_2=38.5 +lat_0=38.5 +lon_0=5", "+R=6371229"},
        Grid{"+proj=lcc +lat_1=30 +lat_2=60 +lat_0=38.5 +lon_0=10 +to_meter=1.25", "+R=6370000"},
        Grid{"+proj=stere +lat_0=90 +lat_ts=60 +lon_0=20", "+ellps=WGS84"},
        Grid{"+proj=stere +lat_0=47 +lon_0=10 +k_0=0.9", "+R=6370000"},
        Grid{"+proj=merc +lat_ts=15 +lon_0=20", "+R=6370000"},
        Grid{"+proj=tmerc +lat_0=49 +lon_0=-2 +k_0=0.9996 +x_0=400000 +y_0=-100000",
             "+a=6377563.396 +rf=299.3249646"},
        Grid{"+proj=laea +lat_0=52 +lon_0=10 +x_0=4321000 +y_0=3210000", "+ellps=GRS80"},
        Grid{"+proj=aeqd +lat_0=52 +lon_0=10", "+R=6370000"},
        Grid{"+proj=aea +lat_1=29.5 +lat_2=45.5 +lat_0=23 +lon_0=-6", "+a=6378206.4 +b=6356583.8"},
        Grid{"+proj=cea +lat_ts=30 +lon_0=5", "+R=6370000"},
        Grid{"+proj=eqc +lat_ts=50 +lat_0=50 +lon_0=8", "+R=6371229"},
        Grid{"+proj=geos +h=35785831 +lon_0=0 +sweep=y", "+a=6378169 +b=6356583.8"}}) {
    const std::string proj = absl::StrCat(grid.proj, " ", grid.earth);
    const auto file = TiffAt(proj, place);
    ASSERT_TRUE(file.ok()) << file.status() << proj;
    const std::string path = folder.File("map.tif");
    std::ofstream(path, std::ios::binary) << *file;
    const volume::EarthPlace corner = CornerOf(path, grid.earth);
    // A metre.
    EXPECT_NEAR(corner.latitude_deg, place.latitude_deg, 9e-6) << proj;
    EXPECT_NEAR(corner.longitude_deg, place.longitude_deg, 1.3e-5) << proj;
  }
}

// The keys of a GeoTIFF have no rotated pole, and GDAL would write a file without a place.
TEST(GeoTiff, IsRefusedForARotatedPole) {
  const auto file =
      TiffAt("+proj=ob_tran +o_proj=eqc +o_lat_p=40 +o_lon_p=0 +lon_0=10 +lat_ts=2 +R=6371229",
             {48.0, 9.0});
  EXPECT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(file.status().message()), ::testing::HasSubstr("use a .nc"));
}

}  // namespace
}  // namespace thunderhead::product
