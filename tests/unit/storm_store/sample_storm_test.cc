// Tests of the supercell in samples/, checked against an independent reading of the file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "glm/common.hpp"
#include "storm_files/wrf_metadata.h"
#include "storm_files/wrf_reader.h"
#include "storm_store/storm_store.h"
#include "volume/storm_map.h"

namespace thunderhead::storm_store {
namespace {

const char* const kSample = THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc";
constexpr int kNx = 200;
constexpr int kNy = 160;
constexpr int kLevels = 60;
constexpr std::size_t kSampleColumns = std::size_t{kNx} * kNy;

std::vector<float> Raw(const char* name, std::size_t record, std::size_t levels) {
  int file = 0;
  int variable = 0;
  std::vector<float> values(levels * kSampleColumns);
  const std::size_t start[] = {record, 0, 0, 0};
  const std::size_t count[] = {1, levels, kNy, kNx};
  EXPECT_EQ(nc_open(kSample, NC_NOWRITE, &file), NC_NOERR);
  EXPECT_EQ(nc_inq_varid(file, name, &variable), NC_NOERR);
  EXPECT_EQ(nc_get_vara_float(file, variable, start, count, values.data()), NC_NOERR);
  EXPECT_EQ(nc_close(file), NC_NOERR);
  return values;
}

// The state of one cell in one layer of the file, in SI units. `density` is the density of dry air.
struct Layer {
  double density;
  double temperature;
  double thickness;
};

// Returns every layer, computed from first principles and in double precision.
std::vector<Layer> ReadLayers(std::size_t record) {
  const auto ph = Raw("PH", record, kLevels + 1);
  const auto phb = Raw("PHB", record, kLevels + 1);
  const auto p = Raw("P", record, kLevels);
  const auto pb = Raw("PB", record, kLevels);
  const auto t = Raw("T", record, kLevels);
  const auto qv = Raw("QVAPOR", record, kLevels);
  std::vector<Layer> layers(kLevels * kSampleColumns);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const double pressure = double{p[i]} + pb[i];
    const double temperature = (double{t[i]} + 300.0) * std::pow(pressure / 1e5, 2.0 / 7.0);
    const double density = pressure / (287.0 * temperature * (1.0 + 1.608 * qv[i]));
    const double bottom = (double{ph[i]} + phb[i]) / 9.81;
    const double top = (double{ph[i + kSampleColumns]} + phb[i + kSampleColumns]) / 9.81;
    layers[i] = {density, temperature, top - bottom};
  }
  return layers;
}

// Returns the result of `read` for a record (time). The result is kept, so that consecutive tests
// of one record read it only once.
template <typename Value, typename Read>
const Value& Kept(std::size_t record, Read read) {
  static std::optional<std::pair<std::size_t, Value>> kept;
  if (!kept.has_value() || kept->first != record) {
    kept.reset();
    kept.emplace(record, read(record));
  }
  return kept->second;
}

const std::vector<Layer>& SampleLayers(std::size_t record) {
  return Kept<std::vector<Layer>>(record, ReadLayers);
}

// Returns the fields as read by the reader under test.
const volume::HydrometeorFields& SampleFields(std::size_t record) {
  return Kept<volume::HydrometeorFields>(record, [](std::size_t wanted) {
    return storm_files::ReadWrfTime(storm_files::ReadWrfMetadata(kSample).value(), wanted,
                                    std::nullopt, {})
        .value();
  });
}

// Returns a store that has read each time once for all tests.
StormStore& SampleStore() {
  static const auto store = StormStore::Open({kSample}, {.read_ahead = 0}).value();
  return *store;
}

// Returns the mass per area of dry air in every layer.
std::vector<double> AirMass(std::size_t record) {
  std::vector<double> mass;
  for (const Layer& layer : SampleLayers(record)) mass.push_back(layer.density * layer.thickness);
  return mass;
}

std::vector<double> PathInFile(const char* name, std::size_t record,
                               const std::vector<double>& air_mass) {
  const auto q = Raw(name, record, kLevels);
  std::vector<double> path(kSampleColumns, 0.0);
  for (std::size_t i = 0; i < q.size(); ++i) path[i % kSampleColumns] += q[i] * air_mass[i];
  return path;
}

std::vector<double> PathOnGrid(const volume::HydrometeorFields& fields,
                               const volume::HydrometeorField& field) {
  std::vector<double> path(kSampleColumns, 0.0);
  for (std::size_t i = 0; i < field.concentration_kg_per_m3.size(); ++i) {
    path[i % kSampleColumns] += field.concentration_kg_per_m3[i] * fields.grid.spacing_m.z;
  }
  return path;
}

TEST(SampleStorm, IsDescribedWithoutReadingFields) {
  const auto store = StormStore::Open({kSample}, {});
  ASSERT_TRUE(store.ok()) << store.status();
  ASSERT_EQ((*store)->Storms().size(), 1U);
  const StormInfo& storm = *(*store)->Storms()[0];
  EXPECT_EQ(storm.id, "supercell");
  EXPECT_EQ(storm.title, "supercell (WRF V4.7.1, idealised)");
  EXPECT_EQ(storm.file_cells, glm::ivec3(kNx, kNy, kLevels));
  EXPECT_EQ(storm.dx_m, 1000.0);
  EXPECT_EQ(storm.dy_m, 1000.0);
  EXPECT_EQ(storm.fields.size(), 5U);
  EXPECT_FALSE(storm.latitude_deg.has_value());
  EXPECT_FALSE(storm.longitude_deg.has_value());
  ASSERT_EQ(storm.times.size(), 4U);
  EXPECT_EQ(storm.times[0].valid_time, "0001-01-01T00:20:00Z");
  EXPECT_EQ(storm.times[3].valid_time, "0001-01-01T01:20:00Z");
  EXPECT_EQ(storm.times[3].elapsed_s, 3600.0);
  EXPECT_EQ((*store)->CachedBytes(), 0U);
}

// The promised accuracy is one per cent. The remaining error is single precision: heights of 20 km
// are accurate to 2 mm, which is 1e-5 of a layer.
TEST(SampleStorm, KeepsTheWaterPathOfEveryColumnAndField) {
  for (std::size_t record = 0; record < 4; ++record) {
    const volume::HydrometeorFields& fields = SampleFields(record);
    ASSERT_EQ(fields.fields.size(), 5U);
    const std::vector<double> air_mass = AirMass(record);
    for (const volume::HydrometeorField& field : fields.fields) {
      const std::vector<double> expected = PathInFile(field.variable.c_str(), record, air_mass);
      const std::vector<double> actual = PathOnGrid(fields, field);
      double worst = 0.0;
      double total = 0.0;
      for (std::size_t i = 0; i < kSampleColumns; ++i) {
        // Below this limit a column contains only denormal remainders.
        constexpr double kNothing_kg_per_m2 = 1e-30;
        worst = std::max(
            worst, std::abs(actual[i] - expected[i]) / std::max(expected[i], kNothing_kg_per_m2));
        total += expected[i];
      }
      EXPECT_LT(worst, 3e-5) << field.variable << " at record " << record;
      EXPECT_GT(total, 0.0);
      EXPECT_NEAR(field.statistics.mean_water_path_kg_per_m2 / (total / kSampleColumns), 1.0, 1e-5);
      EXPECT_NEAR(field.statistics.maximum_water_path_kg_per_m2 /
                      *std::max_element(expected.begin(), expected.end()),
                  1.0, 1e-5);
    }
  }
}

// Returns 3 rho q / (2 rho_f R) by the distributions of WSM6, from first principles.
double Wsm6Extinction_per_m(const std::string& variable, double content, double temperature) {
  const auto exponential = [content](double density, double intercept, double largest_slope) {
    const double slope = std::pow(M_PI * density * intercept / content, 0.25);
    return content * std::min(slope, largest_slope) / density;
  };
  if (variable == "QRAIN") return exponential(1000.0, 8e6, 8e4);
  if (variable == "QGRAUP") return exponential(500.0, 4e6, 6e4);
  if (variable == "QSNOW") {
    const double intercept = 2e6 * std::exp(0.12 * (273.16 - temperature));
    return exponential(100.0, std::clamp(intercept, 2e6, 1e11), 1e5);
  }
  if (variable == "QCLOUD") {
    const double radius = 1.5 / std::cbrt(M_PI * 1000.0 * 3e8 / content);
    return 1.5 * content / (1000.0 * std::clamp(radius, 2.51e-6, 50e-6));
  }
  const double crystals = std::clamp(5.38e7 * std::pow(content, 0.75), 1e3, 1e6);
  const double radius = 0.75 * 0.163 * 11.9 * std::sqrt(content / crystals);
  return 1.5 * content / (917.0 * std::clamp(radius, 10e-6, 125e-6));
}

// The microphysics scheme is WSM6, and the file has no sizes. The remaining difference comes from
// half floats.
TEST(SampleStorm, KeepsTheOpticalDepthOfEveryColumnByItsScheme) {
  constexpr std::size_t kRecord = 1;
  const volume::HydrometeorFields& fields = SampleFields(kRecord);
  const std::vector<Layer>& layers = SampleLayers(kRecord);
  for (const volume::HydrometeorField& field : fields.fields) {
    EXPECT_EQ(field.sizes.origin, volume::SizeOrigin::kScheme);
    EXPECT_EQ(field.sizes.name, "WSM6");
    const auto q = Raw(field.variable.c_str(), kRecord, kLevels);
    std::vector<double> expected(kSampleColumns, 0.0);
    for (std::size_t i = 0; i < q.size(); ++i) {
      const Layer& layer = layers[i];
      if (q[i] <= 0.0F) continue;
      expected[i % kSampleColumns] +=
          layer.thickness *
          Wsm6Extinction_per_m(field.variable, layer.density * q[i], layer.temperature);
    }
    std::vector<float> extinction(field.concentration_kg_per_m3.size(), 0.0F);
    const auto mass_extinction = volume::MassExtinctionOf(
        field, physics::DefaultOptics(field.hydrometeor), physics::SizeSource::kModel);
    volume::AddExtinction(field, mass_extinction, 0, extinction.size(), extinction.data());
    std::vector<double> actual(kSampleColumns, 0.0);
    for (std::size_t i = 0; i < extinction.size(); ++i) {
      actual[i % kSampleColumns] += extinction[i] * fields.grid.spacing_m.z;
    }
    for (std::size_t i = 0; i < kSampleColumns; ++i) {
      // Below this limit a column contains only traces.
      if (expected[i] < 1e-3) continue;
      ASSERT_NEAR(actual[i] / expected[i], 1.0, 1e-3) << field.variable << " " << i;
    }
  }
}

// Finds in the file where graupel and all other fields are strongest.
TEST(SampleStorm, ItsMapAndMaximaAreTheFiles) {
  constexpr std::size_t kRecord = 1;
  const volume::HydrometeorFields& fields = SampleFields(kRecord);
  const volume::StormMap map = volume::MapOf(fields, {{0, 1, 2, 3, 4}, 512, false});
  ASSERT_EQ(map.size_px, glm::ivec2(kNx, kNy));
  const std::vector<double> air_mass = AirMass(kRecord);
  const std::vector<Layer>& layers = SampleLayers(kRecord);
  std::vector<double> all(kSampleColumns, 0.0);
  for (const volume::FieldPeak& peak : map.peaks) {
    const std::string& variable = fields.fields[peak.index].variable;
    const std::vector<double> path = PathInFile(variable.c_str(), kRecord, air_mass);
    for (std::size_t i = 0; i < kSampleColumns; ++i) all[i] += path[i];
    const auto at = static_cast<int>(std::ranges::max_element(path) - path.begin());
    const glm::ivec2 path_from_middle(at % kNx - kNx / 2, at / kNx - kNy / 2);
    const glm::dvec2 column_m = (glm::dvec2(path_from_middle) + 0.5) * 1000.0;
    EXPECT_EQ(peak.column_position_m, column_m) << variable;
    EXPECT_NEAR(peak.column_kg_per_m2 / path[static_cast<std::size_t>(at)], 1.0, 3e-5);
    // The values of the grid's cells are means over the file's layers that the cells overlap.
    const auto q = Raw(variable.c_str(), kRecord, kLevels);
    const auto column_of = [](double x_m, int cells) {
      return static_cast<std::size_t>(std::lround(x_m / 1000.0 - 0.5 + cells / 2.0));
    };
    const std::size_t peak_column =
        column_of(peak.position_m.y, kNy) * kNx + column_of(peak.position_m.x, kNx);
    const double cell_m = fields.grid.spacing_m.z;
    double water = 0.0;
    double air = 0.0;
    double bottom_m = 0.0;
    for (std::size_t i = peak_column; i < q.size(); i += kSampleColumns) {
      const double top_m = bottom_m + layers[i].thickness;
      const double shared_m = std::min(top_m, peak.position_m.z + cell_m / 2.0) -
                              std::max(bottom_m, peak.position_m.z - cell_m / 2.0);
      if (shared_m > 0.0) {
        water += shared_m * layers[i].density * q[i];
        air += shared_m * layers[i].density;
      }
      bottom_m = top_m;
    }
    // Columns keep their water. Cells may differ from plain means because of the slope within
    // layers: here by up to 2.8 %, for ice. The air's density is the mean of its block.
    EXPECT_NEAR(peak.kg_per_m3 / (water / cell_m), 1.0, 0.03) << variable;
    EXPECT_NEAR(peak.value / (water / air), 1.0, 0.03) << variable;
    const auto& grid = fields.grid;
    const glm::ivec3 cell((peak.position_m - grid.low_corner_m) / grid.spacing_m);
    EXPECT_EQ(
        peak.kg_per_m3,
        fields.fields[peak.index].concentration_kg_per_m3[grid.Offset(cell.x, cell.y, cell.z)])
        << variable;
    // The file's largest mixing ratio is in the same column, within a level. It may be higher,
    // because the mean over layers reduces thin maxima, here by up to 6 % for ice.
    const auto largest = static_cast<std::size_t>(std::ranges::max_element(q) - q.begin());
    EXPECT_NEAR(peak.value / q[largest], 0.97, 0.05) << variable;
    double height_m = 0.0;
    for (std::size_t i = largest % kSampleColumns; i < largest; i += kSampleColumns) {
      height_m += layers[i].thickness;
    }
    height_m += layers[largest].thickness / 2.0;
    const auto column = static_cast<int>(largest % kSampleColumns);
    const glm::ivec2 peak_from_middle(column % kNx - kNx / 2, column / kNx - kNy / 2);
    EXPECT_EQ(peak.position_m.x, (peak_from_middle.x + 0.5) * 1000.0) << variable;
    EXPECT_EQ(peak.position_m.y, (peak_from_middle.y + 0.5) * 1000.0) << variable;
    EXPECT_NEAR(peak.position_m.z, height_m, fields.grid.spacing_m.z) << variable;
  }
  for (std::size_t i = 0; i < kSampleColumns; ++i) {
    if (all[i] <= 1e-6) continue;
    ASSERT_NEAR(map.values[i] / all[i], 1.0, 3e-5) << i;
  }
}

// Compares the density of every layer in the file with the mean over its block at the middle of its
// cell.
TEST(SampleStorm, AirsMeansAreWithinAFewPerCentOfEveryLayer) {
  constexpr std::size_t kRecord = 1;
  const volume::HydrometeorFields& fields = SampleFields(kRecord);
  ASSERT_EQ(fields.air.blocks, glm::ivec2(volume::kAirBlocks));
  const std::vector<Layer>& layers = SampleLayers(kRecord);
  double worst = 0.0;
  double squares = 0.0;
  std::size_t count = 0;
  for (std::size_t column = 0; column < kSampleColumns; column += 7) {
    double bottom_m = 0.0;
    for (std::size_t i = column; i < layers.size(); i += kSampleColumns) {
      const double middle_m = bottom_m + layers[i].thickness / 2.0;
      bottom_m += layers[i].thickness;
      const auto z =
          static_cast<int>((middle_m - fields.grid.low_corner_m.z) / fields.grid.spacing_m.z);
      const float air =
          fields.air.At(fields.grid, static_cast<int>(column % kNx), static_cast<int>(column / kNx),
                        std::min(z, fields.grid.cells.z - 1));
      // Converts from the cell's middle to the layer's with the scale height.
      const double cell_m = fields.grid.low_corner_m.z + (z + 0.5) * fields.grid.spacing_m.z;
      const double error = air * std::exp((cell_m - middle_m) / 8000.0) / layers[i].density - 1.0;
      worst = std::max(worst, std::abs(error));
      squares += error * error;
      ++count;
    }
  }
  // The worst layer is in the overshooting top, whose air differs much from its surroundings:
  // 0.091, computed with numpy from the file.
  EXPECT_LT(worst, 0.10);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(count)), 0.01);
}

TEST(SampleStorm, WithoutWindTellsNothingOfTheAir) {
  const volume::HydrometeorFields& fields = SampleFields(1);
  EXPECT_EQ(fields.motion.source, volume::TurbulenceSource::kGradient);
  EXPECT_TRUE(fields.motion.turbulence.empty());
  EXPECT_TRUE(fields.motion.ascent.empty());
}

// The expected peaks over all times are known for this run.
TEST(SampleStorm, HasThePeaksOfItsRun) {
  std::map<std::string, float> peaks;
  for (int time = 0; time < 4; ++time) {
    const auto fields = SampleStore().Get("supercell", time, {});
    ASSERT_TRUE(fields.ok()) << fields.status();
    for (const volume::HydrometeorField& field : (*fields)->fields) {
      float& peak = peaks[field.variable];
      peak = std::max(peak, field.statistics.maximum);
      EXPECT_EQ(field.statistics.minimum, 0.0F);
      EXPECT_EQ(field.statistics.negative_cells, 0);
      EXPECT_EQ(field.statistics.missing_cells, 0);
    }
  }
  EXPECT_NEAR(peaks["QCLOUD"], 3.8e-3, 1e-5);
  EXPECT_NEAR(peaks["QRAIN"], 1.81e-2, 1e-4);
  EXPECT_NEAR(peaks["QICE"], 3.51e-4, 1e-6);
  EXPECT_NEAR(peaks["QSNOW"], 4.33e-3, 1e-5);
  EXPECT_NEAR(peaks["QGRAUP"], 1.45e-2, 1e-4);
}

TEST(SampleStorm, LiesOnOneGridThatIsCentredAndSmall) {
  const auto first = SampleStore().Get("supercell", 0, {});
  ASSERT_TRUE(first.ok()) << first.status();
  const volume::RegularGrid grid = (*first)->grid;
  EXPECT_EQ(grid.cells.x, kNx);
  EXPECT_EQ(grid.cells.y, kNy);
  EXPECT_EQ(grid.low_corner_m, glm::dvec3(-100'000, -80'000, 0));
  EXPECT_GT(grid.HighCorner_m().z, 19'900.0);
  EXPECT_LT(grid.HighCorner_m().z, 20'900.0);
  EXPECT_THAT((*first)->terrain_height_m, ::testing::Each(0.0F));
  EXPECT_EQ((*first)->terrain_height_m.size(), kSampleColumns);
  for (int time = 0; time < 4; ++time) {
    const auto fields = SampleStore().Get("supercell", time, {});
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_EQ((*fields)->grid, grid);
    constexpr std::size_t kRawBytes = 5 * kLevels * kSampleColumns * sizeof(float);
    std::size_t size_bytes = 0;
    for (const volume::HydrometeorField& field : (*fields)->fields) {
      size_bytes += field.sizes.inverse_radius.size() * sizeof(std::uint16_t);
    }
    EXPECT_LE((*fields)->Bytes() - size_bytes, kRawBytes * 3 / 2);
    // There are at most two bytes per cell, and none above and below a field's particles.
    EXPECT_LE(size_bytes, 5 * grid.CellCount() * sizeof(std::uint16_t) * 3 / 4);
  }
}

TEST(SampleStorm, BoxesItsCondensateTightly) {
  const volume::HydrometeorFields& fields = SampleFields(0);
  const volume::CellBox box = fields.condensate;
  glm::ivec3 low = fields.grid.cells;
  glm::ivec3 high(0);
  for (const volume::HydrometeorField& field : fields.fields) {
    for (std::size_t i = 0; i < field.concentration_kg_per_m3.size(); ++i) {
      if (field.concentration_kg_per_m3[i] == 0.0F) continue;
      const glm::ivec3 cell(i % kNx, i / kNx % kNy, i / kSampleColumns);
      low = glm::min(low, cell);
      high = glm::max(high, cell + 1);
    }
  }
  EXPECT_EQ(box.low, low);
  EXPECT_EQ(box.high, high);
  // A young tower fills a small part of the domain.
  EXPECT_LT(high.x - low.x, kNx / 2);
}

TEST(SampleStorm, SaysHowFarItsReadingHasCome) {
  const auto store = StormStore::Open({kSample}, {.read_ahead = 0});
  ASSERT_TRUE(store.ok()) << store.status();
  std::vector<double> shares;
  ASSERT_TRUE((*store)->Get("supercell", 1, [&](double share) { shares.push_back(share); }).ok());
  ASSERT_GE(shares.size(), 10U);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.front(), 0.0);
  EXPECT_EQ(shares.back(), 1.0);
}

TEST(FinerSampleStorm, TellsTheMotionOfItsAir) {
  auto metadata = storm_files::ReadWrfMetadata(
      std::string(THUNDERHEAD_SOURCE_DIR "/samples/supercell-500m.nc"));
  ASSERT_TRUE(metadata.ok()) << metadata.status();
  EXPECT_EQ(metadata->energy.name, "TKE");
  EXPECT_EQ(metadata->wind[0], "U");
  const auto fields = storm_files::ReadWrfTime(*metadata, 1, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  const volume::AirMotion& motion = fields->motion;
  EXPECT_EQ(motion.source, volume::TurbulenceSource::kEnergy);
  ASSERT_EQ(motion.turbulence.size(), fields->grid.CellCount());
  ASSERT_EQ(motion.ascent.size(), fields->grid.CellCount());
  // These are the file's largest energy and updraught at that time, in m2/s2 and m/s.
  EXPECT_GT(*std::ranges::max_element(motion.turbulence), 250);
  EXPECT_NEAR(*std::ranges::max_element(motion.ascent) * volume::kAscentUnit_m_per_s, 55.0, 8.0);
  // The simulation has westerly shear, so the anvil lies in the east.
  EXPECT_GT(motion.shear_m_per_s.x, 10.0);
  EXPECT_LT(std::abs(motion.shear_m_per_s.y), motion.shear_m_per_s.x);
  // The values were computed with numpy. The time is 21:30 on 20 May 2000.
  EXPECT_NEAR(motion.steering_m_per_s.x, 4.766, 0.005);
  EXPECT_NEAR(motion.steering_m_per_s.y, 2.325, 0.005);
  EXPECT_EQ(motion.time_s, 958858200.0);
  // Without the model's energy, the wind's deformation is used.
  metadata->energy = {};
  const auto deformed = storm_files::ReadWrfTime(*metadata, 1, std::nullopt, {});
  ASSERT_TRUE(deformed.ok()) << deformed.status();
  EXPECT_EQ(deformed->motion.source, volume::TurbulenceSource::kDeformation);
  // The energy that is computed from the wind's deformation should agree with the model's own
  // turbulent energy.
  double stirred = 0.0;
  double calm = 0.0;
  double stirred_count = 0.0;
  double calm_count = 0.0;
  for (std::size_t i = 0; i < motion.turbulence.size(); ++i) {
    const double value = deformed->motion.turbulence[i];
    (motion.turbulence[i] > 200 ? stirred : calm) += value;
    (motion.turbulence[i] > 200 ? stirred_count : calm_count) += 1.0;
  }
  EXPECT_GT(stirred / stirred_count, 1.5 * calm / calm_count);
}

}  // namespace
}  // namespace thunderhead::storm_store
