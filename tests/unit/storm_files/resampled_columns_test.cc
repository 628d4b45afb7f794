// Tests of a storm whose columns are resampled to even distances by ReadOnHeights. The storm is a
// blob of cloud of known place, size and mass.
#include "storm_files/resampled_columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/gtc/constants.hpp"
#include "glm/trigonometric.hpp"
#include "storm_files/even_columns.h"
#include "storm_files/fields_on_heights.h"
#include "storm_files/layer_source.h"
#include "tests/support/earth_formulas.h"

namespace thunderhead::storm_files {
namespace {

using testing::Distance_m;
using testing::FromPolar;
using testing::FromStereographic;
using volume::EarthPlace;

constexpr int kLevels = 4;
constexpr float kDepth_m = 500.0F;
constexpr float kRadius_m = 2e-5F;
constexpr float kHalfAmplitudeEnergy = volume::kHalfAmplitudeEnergy_m2_per_s2;

// A longitude/latitude grid around 60 N. A degree of longitude is 0.55 to 0.45 degrees of latitude
// long there.
ColumnPlaces LongitudeLatitudeColumns() {
  ColumnPlaces places;
  places.columns = {160, 120};
  places.projection = "+proj=longlat +R=6370000";
  places.first = {2.0, 57.0};
  places.step = {0.1, 0.05};
  return places;
}

// A polar stereographic grid whose y axis points to the west of north.
ColumnPlaces PolarColumns() {
  ColumnPlaces places;
  places.columns = {90, 90};
  places.projection = "+proj=stere +lat_0=90 +lat_ts=60 +lon_0=-45 +R=6370000";
  places.first = {2.0e6, -2.6e6};
  places.step = {8e3, 8e3};
  return places;
}

// Returns the place of a column, by formulas that do not use PROJ.
EarthPlace PlaceOf(const ColumnPlaces& places, double x, double y) {
  const glm::dvec2 at = places.first + glm::dvec2(x, y) * places.step;
  if (places.projection.find("longlat") != std::string::npos) return {at.y, at.x};
  return FromPolar(at, 60.0, -45.0);
}

// A blob of cloud on flat layers, the same at each height. Its concentration falls off with the
// true distance from `centre`.
struct Blob {
  EarthPlace centre;
  double width_m = 0.0;  // the distance at which the concentration is 1 / e of the largest

  double At(const EarthPlace& place) const {
    const double distance = Distance_m(place, centre) / width_m;
    return 1e-3 * std::exp(-distance * distance);
  }
  // Returns the mass that the blob has in one layer.
  double Mass_kg() const {
    return 1e-3 * glm::pi<double>() * width_m * width_m * static_cast<double>(kDepth_m);
  }
};

class BlobSource final : public LayerSource {
 public:
  BlobSource(ColumnPlaces places, const Blob& blob, const EvenColumns& even)
      : places_(std::move(places)), blob_(blob) {
    domain_.path = "blob";
    domain_.cells = {places_.columns.x, places_.columns.y, kLevels};
    domain_.dx_m = even.mean_m.x;
    domain_.dy_m = even.mean_m.y;
    domain_.even = std::make_shared<const EvenColumns>(even);
    domain_.on_terrain = true;  // so the ground, whose height has its own rules, cuts no layer
    LayerField cloud;
    cloud.variable = "qc";
    cloud.quantity = volume::Quantity::kMassConcentration;
    cloud.sizes = {"re", false};
    domain_.fields = {cloud};
  }

  const LayerDomain& Domain() const override { return domain_; }
  absl::StatusOr<std::vector<float>> InterfaceHeights_m() override {
    std::vector<float> heights_m;
    for (int level = 0; level <= kLevels; ++level) {
      heights_m.insert(heights_m.end(), domain_.Columns(), kDepth_m * static_cast<float>(level));
    }
    return heights_m;
  }
  absl::StatusOr<LayerState> Air() override { return LayerState(); }
  absl::StatusOr<LayerAmounts> Amounts(std::size_t) override {
    LayerAmounts amounts;
    amounts.amounts = Levels([&](int x, int y) { return blob_.At(PlaceOf(places_, x, y)); });
    // Half of the columns have particles twice as large.
    amounts.sizes = Levels([](int x, int) { return x % 2 == 0 ? kRadius_m : 2.0F * kRadius_m; });
    return amounts;
  }
  absl::StatusOr<std::vector<float>> Terrain_m() override {
    return Columns([](int x, int y) { return 10.0 * x + y; });
  }
  absl::StatusOr<volume::LandColumns> Land() override {
    volume::LandColumns land;
    land.land_use = Columns([](int x, int) { return x < 45 ? 16.0 : 2.0; });  // water; dry land
    return land;
  }
  absl::StatusOr<LayerEnergy> TurbulentEnergy() override {
    return LayerEnergy{"tke", Levels([](int, int) { return kHalfAmplitudeEnergy; })};
  }
  absl::StatusOr<ModelWind> Wind() override {
    ModelWind wind;
    wind.cells = domain_.cells;
    wind.dx_m = domain_.dx_m;
    wind.dy_m = domain_.dy_m;
    wind.on_faces = false;
    wind.east_and_north = east_and_north;
    wind.u_m_per_s = Levels([](int, int) { return 3.0; });
    wind.v_m_per_s = Levels([](int, int) { return 12.0; });
    wind.w_m_per_s = Levels([](int, int) { return 1.0; });
    return wind;
  }

  bool east_and_north = false;

 private:
  template <typename Value>
  std::vector<float> Columns(Value value) const {
    std::vector<float> values;
    for (int y = 0; y < places_.columns.y; ++y) {
      for (int x = 0; x < places_.columns.x; ++x) values.push_back(static_cast<float>(value(x, y)));
    }
    return values;
  }
  template <typename Value>
  std::vector<float> Levels(Value value) const {
    const std::vector<float> level = Columns(value);
    std::vector<float> values;
    for (int i = 0; i < kLevels; ++i) values.insert(values.end(), level.begin(), level.end());
    return values;
  }

  const ColumnPlaces places_;
  const Blob blob_;
  LayerDomain domain_;
};

struct BlobRead {
  EvenColumns even;
  volume::HydrometeorFields fields;
};

BlobRead ReadBlob(const ColumnPlaces& places, const Blob& blob, bool east_and_north = false) {
  auto even = MakeEven(places);
  EXPECT_TRUE(even.ok()) << even.status();
  EXPECT_TRUE(even->Resampled());
  BlobSource source(places, blob, *even);
  source.east_and_north = east_and_north;
  auto fields = ReadOnHeights(source, 0, std::nullopt, {});
  EXPECT_TRUE(fields.ok()) << fields.status();
  return {*even, *std::move(fields)};
}

TEST(ResampledColumns, ABlobKeepsItsPlaceSizeAndMass) {
  for (const ColumnPlaces& places : {LongitudeLatitudeColumns(), PolarColumns()}) {
    SCOPED_TRACE(places.projection);
    // The blob is far from the middle of the domain.
    const Blob blob{PlaceOf(places, 0.3 * places.columns.x, 0.7 * places.columns.y), 40e3};
    const auto [even, fields] = ReadBlob(places, blob);
    const volume::RegularGrid& grid = fields.grid;
    EXPECT_EQ(glm::ivec2(grid.cells), even.columns);
    EXPECT_EQ(grid.spacing_m.x, even.dx_m);
    EXPECT_EQ(grid.low_corner_m.x, -0.5 * even.dx_m * even.columns.x);
    const std::vector<float>& values = fields.fields[0].concentration_kg_per_m3;
    ASSERT_EQ(values.size(), grid.CellCount());
    double sum = 0.0;
    glm::dvec2 moment(0.0);
    for (int y = 0; y < grid.cells.y; ++y) {
      for (int x = 0; x < grid.cells.x; ++x) {
        sum += values[grid.Offset(x, y, 1)];
        moment += glm::dvec2(x, y) * static_cast<double>(values[grid.Offset(x, y, 1)]);
      }
    }
    EXPECT_NEAR(sum * even.dx_m * even.dy_m * kDepth_m / blob.Mass_kg(), 1.0, 0.01);
    // The middle of the blob is within half a cell of its place.
    const glm::dvec2 middle =
        (moment / sum - 0.5 * glm::dvec2(even.columns - 1)) * glm::dvec2(even.dx_m, even.dy_m);
    EXPECT_LT(Distance_m(FromStereographic(middle, even.middle), blob.centre),
              0.5 * std::min(even.dx_m, even.dy_m));
    double spread_m2 = 0.0;
    for (int y = 0; y < grid.cells.y; ++y) {
      for (int x = 0; x < grid.cells.x; ++x) {
        const glm::dvec2 off_m =
            (glm::dvec2(x, y) - moment / sum) * glm::dvec2(even.dx_m, even.dy_m);
        spread_m2 += glm::dot(off_m, off_m) * values[grid.Offset(x, y, 1)] / sum;
      }
    }
    EXPECT_NEAR(std::sqrt(spread_m2) / blob.width_m, 1.0, 0.01);
  }
}

TEST(ResampledColumns, StatisticsAreThoseOfTheFile) {
  const ColumnPlaces places = LongitudeLatitudeColumns();
  const Blob blob{PlaceOf(places, 80.0, 60.0), 8e3};
  const auto [even, fields] = ReadBlob(places, blob);
  const volume::FieldStatistics& statistics = fields.fields[0].statistics;
  EXPECT_EQ(statistics.maximum, 1e-3F);
  EXPECT_NEAR(statistics.maximum_water_path_kg_per_m2, 1e-3 * kDepth_m * kLevels, 1e-6);
  double sum = 0.0;
  for (int y = 0; y < places.columns.y; ++y) {
    for (int x = 0; x < places.columns.x; ++x) sum += blob.At(PlaceOf(places, x, y));
  }
  EXPECT_NEAR(statistics.mean_water_path_kg_per_m2 * places.columns.x * places.columns.y /
                  (sum * kDepth_m * kLevels),
              1.0, 1e-4);
}

// Extinction is proportional to concentration over radius. Its ratio to the mass is that of the
// model, in which half of the columns have particles twice as large.
TEST(ResampledColumns, ParticleSizesKeepTheExtinctionPerMass) {
  const ColumnPlaces places = LongitudeLatitudeColumns();
  const auto [even, fields] = ReadBlob(places, {PlaceOf(places, 80.0, 60.0), 60e3});
  const volume::HydrometeorField& cloud = fields.fields[0];
  double mass = 0.0;
  double per_radius = 0.0;
  for (std::size_t cell = cloud.sizes.first_cell; cell < cloud.sizes.EndCell(); ++cell) {
    const double content = cloud.concentration_kg_per_m3[cell];
    if (content <= 0.0) continue;
    mass += content;
    per_radius += content * volume::InverseRadius_per_m(cloud.sizes, cell);
  }
  const double mean_per_m = 0.5 * (1.0 / kRadius_m + 0.5 / kRadius_m);
  EXPECT_NEAR(per_radius / mass / mean_per_m, 1.0, 0.005);
  EXPECT_NEAR(cloud.sizes.mean_radius_m * mean_per_m, 1.0, 0.005);
}

TEST(ResampledColumns, TheGroundAndTheAirFollowTheColumns) {
  const ColumnPlaces places = PolarColumns();
  const auto [even, fields] = ReadBlob(places, {PlaceOf(places, 45.0, 45.0), 40e3});
  const volume::RegularGrid& grid = fields.grid;
  int outside = 0;
  for (std::size_t at = 0; at < even.from.size(); ++at) {
    const FromColumn& from = even.from[at];
    const std::size_t column = from.south_west % 90;
    const std::size_t row = from.south_west / 90;
    const double x = column + static_cast<double>(from.east);
    const double y = row + static_cast<double>(from.north);
    ASSERT_NEAR(fields.terrain_height_m[at], 10.0 * x + y, 1e-3);
    if (std::abs(x - 44.5) > 1.0) {
      ASSERT_EQ(fields.land.texels[at].w, x < 44.5 ? 255 : 0) << x;
    }
    // Half of the largest byte, and 1 m/s in units of 0.25 m/s.
    ASSERT_EQ(fields.motion.turbulence[at], from.inside ? 128 : 0);
    ASSERT_EQ(fields.motion.ascent[at], from.inside ? 4 : 0);
    if (from.inside) continue;
    ++outside;
    ASSERT_EQ(fields.fields[0].concentration_kg_per_m3[at], 0.0F);
  }
  EXPECT_GT(outside, 1000);  // the model's domain is turned, so the corners are empty
  EXPECT_LE(fields.condensate.high.x, grid.cells.x);
}

// The even columns have north up. The model's y axis points to the west of north there.
TEST(ResampledColumns, WindsAreTurnedToTheEvenAxes) {
  const ColumnPlaces places = PolarColumns();
  const Blob blob{PlaceOf(places, 45.0, 45.0), 40e3};
  const glm::dvec2 turned = ReadBlob(places, blob).fields.motion.steering_m_per_s;
  const EarthPlace south = PlaceOf(places, 44.5, 44.0);
  const EarthPlace north = PlaceOf(places, 44.5, 45.0);
  const double shrink = std::cos(glm::radians(0.5 * (south.latitude_deg + north.latitude_deg)));
  const glm::dvec2 axis =
      glm::normalize(glm::dvec2((north.longitude_deg - south.longitude_deg) * shrink,
                                north.latitude_deg - south.latitude_deg));
  EXPECT_GT(std::abs(axis.x), 0.3);
  EXPECT_NEAR(turned.x, 12.0 * axis.x + 3.0 * axis.y, 0.1);
  EXPECT_NEAR(turned.y, 12.0 * axis.y - 3.0 * axis.x, 0.1);
  const glm::dvec2 kept = ReadBlob(places, blob, true).fields.motion.steering_m_per_s;
  EXPECT_NEAR(kept.x, 3.0, 1e-3);
  EXPECT_NEAR(kept.y, 12.0, 1e-3);
}

}  // namespace
}  // namespace thunderhead::storm_files
