// Tests of CF files that have a part of a model's layers, with the heights of half levels (HHL).
// The levels are matched by their numbers, so each layer has its own thickness and height.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "tests/unit/storm_files/cf_file_test.h"

namespace thunderhead::storm_files::cf_levels_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::SyntheticCf;
using Numbers = std::vector<double>;

// A model has eight layers between these half levels, which are numbered from 1 at the top. The
// thickness of a layer tells which one it is.
constexpr std::array kHalfLevel_m = {6400.0, 4900.0, 3600.0, 2500.0, 1600.0,
                                     900.0,  400.0,  100.0,  0.0};
constexpr double kCloud_kg_per_m3 = 1e-4;

// The ground rises by 50 m from column to column.
double Ground_m(const Index& at) { return 50.0 * static_cast<double>(at.at("x")); }

double Thickness_m(double level) {
  const auto k = static_cast<std::size_t>(level);
  return kHalfLevel_m[k - 1] - kHalfLevel_m[k];
}

// Returns a file with cloud in the layer with the number `cloudy`. `layers` and `half_levels` are
// the numbers of the levels that the file has.
SyntheticCf Part(const Numbers& layers, const Numbers& half_levels, double cloudy,
                 const std::string& name = "HHL") {
  SyntheticCf file = testing::ExtinctionFile(6, 4, layers.size(), 1000.0, 1000.0, 500.0, {});
  const std::map<std::string, std::string> vertical = {{"axis", "Z"}, {"positive", "down"}};
  file.coordinates[2] = {"lev", layers, vertical, {}};
  file.coordinates.push_back({"lev_2", half_levels, vertical, {}});
  file.variables = {{"qc",
                     {"lev", "y", "x"},
                     {{"units", "kg m-3"}},
                     [layers, cloudy](const Index& at) {
                       return layers[at.at("lev")] == cloudy ? kCloud_kg_per_m3 : 0.0;
                     }},
                    {name, {"lev_2", "y", "x"}, {{"units", "m"}}, [half_levels](const Index& at) {
                       const auto k = static_cast<std::size_t>(half_levels[at.at("lev_2")]);
                       return Ground_m(at) + kHalfLevel_m[k - 1];
                     }}};
  return file;
}

Numbers From(double first, double last) {
  Numbers numbers;
  const double step = last < first ? -1.0 : 1.0;
  for (double each = first; each != last + step; each += step) numbers.push_back(each);
  return numbers;
}

class CfLevels : public CfFileTest {
 protected:
  // Expects the cloud of layer `cloudy` at its own height, and the ground below it.
  void ExpectCloud(const SyntheticCf& file, double cloudy) {
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    const volume::FieldStatistics& statistics = (*fields)->fields[0].statistics;
    const double path_kg_per_m2 = kCloud_kg_per_m3 * Thickness_m(cloudy);
    EXPECT_NEAR(statistics.mean_water_path_kg_per_m2, path_kg_per_m2, 1e-6);
    EXPECT_NEAR(statistics.maximum_water_path_kg_per_m2, path_kg_per_m2, 1e-6);
    const volume::RegularGrid& grid = (*fields)->grid;
    const auto bottom = static_cast<std::size_t>(cloudy);
    // The cloud is at one place, to a cell.
    const double base_m = grid.low_corner_m.z + (*fields)->condensate.low.z * grid.spacing_m.z;
    EXPECT_NEAR(base_m, kHalfLevel_m[bottom], grid.spacing_m.z);
    const double top_m = grid.low_corner_m.z + (*fields)->condensate.high.z * grid.spacing_m.z;
    EXPECT_NEAR(top_m, kHalfLevel_m[bottom - 1] + Ground_m({{"x", 5}}), grid.spacing_m.z);
    EXPECT_NEAR((*fields)->terrain_height_m[0], 0.0F, 1e-3);
    EXPECT_NEAR((*fields)->terrain_height_m[5], 250.0F, 1e-3);
  }
};

TEST_F(CfLevels, EveryPartOfTheLayersHasItsOwnHeights) {
  for (const auto& [first, last, cloudy] : {std::array{4.0, 6.0, 5.0},
                                            {6.0, 8.0, 6.0},
                                            {1.0, 3.0, 1.0},
                                            {2.0, 8.0, 7.0},
                                            {5.0, 5.0, 5.0}}) {
    SCOPED_TRACE(::testing::Message() << first << " to " << last);
    ExpectCloud(Part(From(first, last), From(1, 9), cloudy), cloudy);
    EXPECT_THAT(info_.assumptions, Contains(HasSubstr("those of HHL")));
    const auto says_ground = Contains(HasSubstr("The ground is the lowest half level of HHL"));
    if (last < 8.0) {
      EXPECT_THAT(info_.assumptions, says_ground);
    } else {
      EXPECT_THAT(info_.assumptions, Not(says_ground));
    }
    // In the file, the layers and the half levels may both run from the bottom up.
    ExpectCloud(Part(From(last, first), From(9, 1), cloudy), cloudy);
  }
}

TEST_F(CfLevels, HalfLevelsMayBeAPartToo) {
  SyntheticCf file = Part(From(4, 6), From(3, 8), 5.0);
  file.variables.push_back({"HSURF", {"y", "x"}, {{"units", "m"}}, Ground_m});
  ExpectCloud(file, 5.0);
  EXPECT_THAT(info_.assumptions, Not(Contains(HasSubstr("The ground is"))));
}

// CDO numbers layers by the middles of their half levels, which it writes as bounds.
TEST_F(CfLevels, BoundsGiveTheHalfLevels) {
  SyntheticCf file = Part(From(4, 6), From(1, 9), 5.0);
  file.coordinates[2].faces = {4.0, 5.0, 6.0, 7.0};
  ExpectCloud(file, 5.0);
  file.coordinates[2].values = {4.5, 5.5, 6.5};
  ExpectCloud(file, 5.0);
  file.coordinates[2].faces.clear();
  ExpectCloud(file, 5.0);
}

TEST_F(CfLevels, MiddlesAreMatchedByNumber) {
  SyntheticCf file = Part(From(4, 6), From(1, 8), 5.0, "z_mc");
  file.variables.push_back({"HSURF", {"y", "x"}, {{"units", "m"}}, Ground_m});
  file.variables[1].value = [](const Index& at) {
    const std::size_t k = at.at("lev_2");
    return Ground_m(at) + 0.5 * (kHalfLevel_m[k] + kHalfLevel_m[k + 1]);
  };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  // The middles of the layers 4, 5 and 6 are at 2050, 1250 and 650 m.
  EXPECT_NEAR((*fields)->fields[0].statistics.mean_water_path_kg_per_m2,
              kCloud_kg_per_m3 * (1650.0 - 950.0), 1e-6);
}

TEST_F(CfLevels, HalfLevelsThatAreMissingAreNamed) {
  // Layers and half levels were cut to the same numbers, so the half level below the last layer is
  // missing.
  ExpectError(Part(From(4, 6), From(4, 6), 5.0),
              "HHL, because it has the half levels 4 to 6 (lev_2) where the layers 4 to 6 (lev) "
              "need 4 to 7; give the missing levels");
  // These files have four half levels, as many as the layers need, but not the right ones.
  ExpectError(Part(From(4, 6), From(1, 4), 5.0), "where the layers 4 to 6 (lev) need 4 to 7");
  ExpectError(Part(From(4, 6), From(3, 6), 5.0), "where the layers 4 to 6 (lev) need 4 to 7");
  ExpectError(Part(From(4, 6), From(6, 9), 5.0), "where the layers 4 to 6 (lev) need 4 to 7");
}

TEST_F(CfLevels, LevelsInOppositeOrdersAreRefused) {
  ExpectError(Part(From(8, 1), From(1, 9), 5.0), "give both the same order");
  ExpectError(Part(From(6, 4), From(1, 9), 5.0), "give both the same order");
}

TEST_F(CfLevels, HalfLevelsOnTheLayersDimensionAreRefused) {
  SyntheticCf file = Part(From(4, 6), From(4, 6), 5.0);
  file.variables[1].dimensions[0] = "lev";
  file.variables[1].value = [](const Index& at) {
    return Ground_m(at) + kHalfLevel_m[3 + at.at("lev")];
  };
  ExpectError(file, "it has only 3 half levels, on lev, where 3 layers need 4");
}

TEST_F(CfLevels, WithoutNumbersAllLevelsMustBeThere) {
  SyntheticCf part = Part(From(4, 6), From(1, 9), 5.0);
  part.coordinates[3].written = false;
  ExpectError(part, "it has 9 half levels (lev_2) for 3 layers (lev), and lev_2 has no numbers");
  part.coordinates[2].written = false;
  part.variables[0].dimensions[0] = part.coordinates[2].name = "level";
  part.variables[0].value = [](const Index&) { return kCloud_kg_per_m3; };
  ExpectError(part, "level has no numbers of levels to match them by");
  // With all levels nothing is assumed.
  SyntheticCf whole = Part(From(1, 8), From(1, 9), 5.0);
  whole.coordinates[3].written = false;
  ExpectCloud(whole, 5.0);
  EXPECT_THAT(info_.assumptions, Not(Contains(HasSubstr("have no numbers"))));
  // If a file has a part of the layers and exactly as many half levels as they need, the half
  // levels are taken as those of the layers.
  SyntheticCf cut = Part(From(6, 8), From(6, 9), 7.0);
  cut.coordinates[3].written = false;
  ExpectCloud(cut, 7.0);
  EXPECT_THAT(info_.assumptions,
              Contains("The 4 half levels of HHL have no numbers, and are taken as those of the "
                       "levels 6 to 8."));
}

// Other models number the faces of layers from 0.
TEST_F(CfLevels, FacesMayBeNumberedFromZero) {
  SyntheticCf file = Part(From(1, 8), From(1, 9), 5.0, "altitude");
  file.coordinates[3].values = From(0, 8);
  ExpectCloud(file, 5.0);
  // If the file has only a part of the layers, the numbers do not show whether the faces are
  // numbered from 0 or from 1.
  SyntheticCf part = Part(From(4, 6), From(1, 9), 5.0, "altitude");
  ExpectError(part, "its name does not say whether these are half levels");
}

// COSMO and ICON write the heights of half levels once, to a file of their own.
class CfHeightsFile : public CfLevels {
 protected:
  // Writes a file of the run with these coordinates and variables of `from`.
  void WritePart(const SyntheticCf& from, const std::vector<std::string>& coordinates,
                 const std::vector<std::string>& variables, double hours, const std::string& name) {
    SyntheticCf file;
    for (const testing::CfCoordinate& each : from.coordinates) {
      if (std::ranges::find(coordinates, each.name) != coordinates.end()) {
        file.coordinates.push_back(each);
      }
    }
    file.coordinates.push_back({"time", {hours}, {{"units", "hours since 2013-05-20"}}, {}});
    for (testing::CfContent each : from.variables) {
      if (std::ranges::find(variables, each.name) == variables.end()) continue;
      each.dimensions.insert(each.dimensions.begin(), "time");
      file.variables.push_back(std::move(each));
    }
    testing::WriteCf(file, run_ + "/" + name);
  }
  void WriteHeights(const SyntheticCf& from, const std::string& name = "lfff00000000c.nc") {
    WritePart(from, {"x", "y", "lev_2"}, {"HHL", "HSURF"}, 0.0, name);
  }
  void WriteTime(const SyntheticCf& from, double hours, const std::string& name) {
    WritePart(from, {"x", "y", "lev"}, {"qc"}, hours, name);
  }
  std::string ErrorOf(const std::string& path) {
    return std::string(storm_store::StormStore::Open({path}, {.read_ahead = 0}).status().message());
  }

  const std::string run_ = [this] {
    const std::string path = folder_.File("run");
    std::filesystem::create_directory(path);
    return path;
  }();
};

TEST_F(CfHeightsFile, IsReadWithEachTime) {
  SyntheticCf merged = Part(From(4, 6), From(1, 9), 5.0);
  merged.variables.push_back({"HSURF", {"y", "x"}, {{"units", "m"}}, Ground_m});
  const auto expected = Read(merged);
  ASSERT_TRUE(expected.ok()) << expected.status();
  WriteHeights(merged);
  WriteTime(merged, 1.0, "lfff00010000.nc");
  WriteTime(Part(From(4, 6), From(1, 9), 6.0), 2.0, "lfff00020000.nc");
  auto store = storm_store::StormStore::Open({run_}, {.read_ahead = 0});
  ASSERT_TRUE(store.ok()) << store.status();
  ASSERT_EQ((*store)->Storms().size(), 1U);
  const storm_store::StormInfo& storm = *(*store)->Storms().front();
  EXPECT_EQ(storm.times.size(), 2U);
  EXPECT_THAT(storm.assumptions, Contains(HasSubstr("lfff00000000c.nc")));
  const auto first = (*store)->Get(storm.id, 0, {});
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_EQ((*first)->grid.low_corner_m.z, (*expected)->grid.low_corner_m.z);
  EXPECT_EQ((*first)->terrain_height_m, (*expected)->terrain_height_m);
  EXPECT_EQ((*first)->fields[0].concentration_kg_per_m3,
            (*expected)->fields[0].concentration_kg_per_m3);
  const auto second = (*store)->Get(storm.id, 1, {});
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_NEAR((*second)->fields[0].statistics.mean_water_path_kg_per_m2,
              kCloud_kg_per_m3 * Thickness_m(6.0), 1e-6);
}

TEST_F(CfHeightsFile, IsNamedIfItIsMissingOrAmbiguous) {
  const SyntheticCf merged = Part(From(4, 6), From(1, 9), 5.0);
  WriteTime(merged, 1.0, "lfff00010000.nc");
  EXPECT_THAT(ErrorOf(run_ + "/lfff00010000.nc"),
              ::testing::AllOf(HasSubstr("give the folder with all of them"), HasSubstr("HHL")));
  EXPECT_THAT(ErrorOf(run_), HasSubstr("HHL"));
  WriteHeights(merged);
  EXPECT_EQ(ErrorOf(run_), "");
  WriteHeights(merged, "other_c.nc");
  EXPECT_THAT(ErrorOf(run_), HasSubstr("both have the heights of one time"));
  // Heights on other columns belong to another run, so they are not used.
  SyntheticCf other = merged;
  for (double& x_m : other.coordinates[0].values) x_m += 500.0;
  std::filesystem::remove(run_ + "/other_c.nc");
  WriteHeights(other);
  EXPECT_THAT(ErrorOf(run_), HasSubstr("no file of this run with a time is beside it"));
}

}  // namespace
}  // namespace thunderhead::storm_files::cf_levels_test
