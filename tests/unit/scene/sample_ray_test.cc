// Tests of a vertical ray through the sample supercell's graupel, checked against an independent
// reading of the file.
#include <netcdf.h>

#include <array>
#include <cmath>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "scene/ray_probe.h"
#include "storm_store/storm_store.h"

namespace thunderhead::scene {
namespace {

const char* const kSample = THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc";
constexpr std::size_t kRecord = 1;
constexpr std::size_t kNx = 200;
constexpr std::size_t kNy = 160;
constexpr std::size_t kLevels = 60;

// Returns the values of column (x, y) at levels of the file, or of all columns.
std::vector<float> Raw(const char* name, std::array<std::size_t, 4> start,
                       std::array<std::size_t, 4> count) {
  int file = 0;
  int variable = 0;
  std::vector<float> values(count[1] * count[2] * count[3]);
  EXPECT_EQ(nc_open(kSample, NC_NOWRITE, &file), NC_NOERR);
  EXPECT_EQ(nc_inq_varid(file, name, &variable), NC_NOERR);
  EXPECT_EQ(nc_get_vara_float(file, variable, start.data(), count.data(), values.data()), NC_NOERR);
  EXPECT_EQ(nc_close(file), NC_NOERR);
  return values;
}

TEST(SampleRay, GraupelAboveAColumnIsTheFiles) {
  const auto graupel = Raw("QGRAUP", {kRecord, 0, 0, 0}, {1, kLevels, kNy, kNx});
  const auto largest =
      static_cast<std::size_t>(std::ranges::max_element(graupel) - graupel.begin());
  const std::size_t column = largest % (kNx * kNy);
  const std::size_t x = column % kNx;
  const std::size_t y = column / kNx;
  const auto of_column = [&](const char* name, std::size_t levels) {
    return Raw(name, {kRecord, 0, y, x}, {1, levels, 1, 1});
  };
  const auto ph = of_column("PH", kLevels + 1);
  const auto phb = of_column("PHB", kLevels + 1);
  const auto p = of_column("P", kLevels);
  const auto pb = of_column("PB", kLevels);
  const auto t = of_column("T", kLevels);
  const auto qv = of_column("QVAPOR", kLevels);
  double path_kg_per_m2 = 0.0;
  std::vector<double> middles_m;
  for (std::size_t level = 0; level < kLevels; ++level) {
    const double pressure = double{p[level]} + pb[level];
    const double temperature = (double{t[level]} + 300.0) * std::pow(pressure / 1e5, 2.0 / 7.0);
    const double density = pressure / (287.0 * temperature * (1.0 + 1.608 * qv[level]));
    const double bottom_m = (double{ph[level]} + phb[level]) / 9.81;
    const double top_m = (double{ph[level + 1]} + phb[level + 1]) / 9.81;
    middles_m.push_back((bottom_m + top_m) / 2.0);
    path_kg_per_m2 += graupel[level * kNx * kNy + column] * density * (top_m - bottom_m);
  }

  const auto store = storm_store::StormStore::Open({kSample}, {.read_ahead = 0});
  ASSERT_TRUE(store.ok()) << store.status();
  const auto fields = (*store)->Get("supercell", kRecord, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  Scene scene;
  scene.camera = TopDownCamera();
  const glm::dvec3 origin_m((static_cast<double>(x) - kNx / 2.0 + 0.5) * 1000.0,
                            (static_cast<double>(y) - kNy / 2.0 + 0.5) * 1000.0, 30000.0);
  const StormRay ray(scene, **fields, origin_m, {0.0, 0.0, -1.0});
  const RayProbe probe = ProbeRay(scene, **fields, ray, {1024, 0.1});
  const auto at = std::ranges::find_if(probe.fields, [&](const FieldOnRay& field) {
    return (*fields)->fields[field.index].variable == "QGRAUP";
  });
  ASSERT_NE(at, probe.fields.end());
  // The path is exact except for the last metre above the ground.
  EXPECT_NEAR(at->path_kg_per_m2 / path_kg_per_m2, 1.0, 1e-3);
  // The largest value is in a grid whose cells are means of the layers that they overlap. The
  // density of the air in a grid cell is the mean over a block of cells.
  EXPECT_NEAR(at->maximum / graupel[largest], 1.0, 0.03);
  EXPECT_NEAR(ray.At_m(*at->maximum_m).z, middles_m[largest / (kNx * kNy)],
              (*fields)->grid.spacing_m.z);
  // All values must be linear between the file's levels.
  for (std::size_t i = 0; i < probe.distances_m.size(); ++i) {
    const double height_m = ray.At_m(probe.distances_m[i]).z;
    const auto above = std::ranges::upper_bound(middles_m, height_m);
    if (above == middles_m.begin() || above == middles_m.end()) continue;
    const auto level = static_cast<std::size_t>(above - middles_m.begin()) - 1;
    const double share = (height_m - middles_m[level]) / (middles_m[level + 1] - middles_m[level]);
    const double expected = std::lerp(graupel[level * kNx * kNy + column],
                                      graupel[(level + 1) * kNx * kNy + column], share);
    EXPECT_NEAR(at->values[i], expected, 0.05 * graupel[largest]) << height_m << " m";
  }
}

}  // namespace
}  // namespace thunderhead::scene
