// Tests of reading whole GRIB files in the layouts of weather centres, against what is known of
// them (truth.json in ../shared/data/grib).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "absl/strings/match.h"
#include "glm/trigonometric.hpp"
#include "glm/vec2.hpp"
#include "storm_files/grib_columns.h"
#include "storm_files/grib_storm.h"
#include "storm_files/storm_format.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path Folder() {
  return std::filesystem::path(THUNDERHEAD_SOURCE_DIR).parent_path() / "shared/data/grib";
}

// One time of a set, with what is known of it.
struct Time {
  std::vector<std::string> paths;
  json truth;  // of this time
  json grid;
};

Time TimeOf(const std::string& set, std::size_t index) {
  std::ifstream file(Folder() / set / "truth.json");
  EXPECT_TRUE(file.is_open()) << set << " is missing in the folder shared beside the repository";
  const json truth = json::parse(file);
  Time time{{}, truth["times"][index], truth["grid"]};
  if (time.truth.contains("file")) {
    time.paths.push_back((Folder() / set / time.truth["file"]).string());
    return time;
  }
  // Adds the files of this hour, and the files that hold for all hours.
  std::string begin = time.truth["files"];
  begin.pop_back();
  for (const auto& entry : std::filesystem::directory_iterator(Folder() / set)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(begin) || absl::StrContains(name, "time-invariant")) {
      time.paths.push_back(entry.path().string());
    }
  }
  std::ranges::sort(time.paths);
  return time;
}

absl::StatusOr<StormFile> Describe(const Time& time) {
  const StormFormats formats = StormFormats::BuiltIn();
  return time.paths.size() == 1 ? formats.Describe(time.paths[0])
                                : formats.DescribeTogether(time.paths);
}

std::shared_ptr<const GribStorm> StormOf(const Time& time) {
  std::vector<GribInput> files;
  GribIndexes indexes;
  for (const std::string& path : time.paths) {
    files.push_back(GribFileAt(path));
    indexes.push_back(*IndexOfGrib(*base::OpenBytes(path)));
  }
  const auto storms = MakeGribStorms(time.paths[0], files, indexes);
  EXPECT_TRUE(storms.ok()) << storms.status();
  return storms.ok() ? storms->front() : nullptr;
}

absl::Time ParsedTime(const std::string& text) {
  absl::Time time;
  std::string error;
  EXPECT_TRUE(absl::ParseTime("%Y-%m-%dT%H:%MZ", text, &time, &error)) << error;
  return time;
}

// A set of files, and the index of the time in it.
struct Case {
  const char* name;
  const char* set;
  std::size_t index;
};

class GribTruth : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override { time_ = TimeOf(GetParam().set, GetParam().index); }

  // Returns the level of the file as a layer counted from the ground.
  std::size_t LayerOf(const GribLayers& layers, double level) const {
    const bool is_isobaric = layers.vertical == GribVertical::kIsobaric;
    const double wanted = is_isobaric ? 100.0 * level : level;
    for (std::size_t i = 0; i < layers.levels.size(); ++i) {
      if (std::abs(layers.levels[i] - wanted) > 1e-3) continue;
      const bool downwards = !is_isobaric && time_.truth["columns"][0]["heights_asl_m"][0] >
                                                 time_.truth["columns"][0]["heights_asl_m"][1];
      return downwards ? layers.levels.size() - 1 - i : i;
    }
    ADD_FAILURE() << "no level " << level;
    return 0;
  }

  // Returns the distance of the western from the eastern columns in the middle, and of the southern
  // from the northern ones.
  glm::dvec2 Size_m() const {
    const json& corners = time_.grid["corners_lat_lon"];
    const auto angle = [&](const char* corner, int which) {
      return glm::radians(corners[corner][which].get<double>());
    };
    const double radius_m = time_.grid["earth_radius_m"];
    const double latitude = 0.5 * (angle("southwest", 0) + angle("northeast", 0));
    return radius_m *
           glm::dvec2((angle("southeast", 1) - angle("southwest", 1)) * std::cos(latitude),
                      angle("northwest", 0) - angle("southwest", 0));
  }
  glm::dvec2 Columns() const { return {time_.grid["nx"].get<int>(), time_.grid["ny"].get<int>()}; }
  double Area_m2() const {
    const glm::dvec2 size_m = Size_m() * Columns() / (Columns() - 1.0);
    return size_m.x * size_m.y;
  }

  Time time_;
};

INSTANTIATE_TEST_SUITE_P(
    Sets, GribTruth,
    ::testing::Values(Case{"HrrrNative0", "hrrr-native", 0}, Case{"HrrrNative1", "hrrr-native", 1},
                      Case{"HrrrNative2", "hrrr-native", 2},
                      Case{"HrrrPressure", "hrrr-pressure", 0}, Case{"Gfs", "gfs-0p25-like", 0},
                      Case{"Ifs", "ifs-like", 0}, Case{"IconSimple", "icon-d2-like", 0},
                      Case{"IconCcsds", "icon-d2-like", 1}),
    [](const auto& parameter) { return parameter.param.name; });

TEST_P(GribTruth, TimeAndPlace) {
  const auto file = Describe(time_);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->times, ElementsAre(ParsedTime(time_.truth["valid_time"])));
  // The middle lies between opposite corners, whose places are known.
  const json& corners = time_.grid["corners_lat_lon"];
  const double latitude_deg =
      (corners["southwest"][0].get<double>() + corners["northeast"][0].get<double>()) / 2.0;
  const double longitude_deg =
      (corners["southwest"][1].get<double>() + corners["northeast"][1].get<double>()) / 2.0;
  EXPECT_NEAR(*file->latitude_deg, latitude_deg, 1e-3);
  EXPECT_NEAR(*file->longitude_deg, std::remainder(longitude_deg, 360.0), 2e-3);
  const glm::dvec2 spacing_m = Size_m() / (Columns() - 1.0);
  EXPECT_NEAR(file->dx_m, spacing_m.x, 0.01 * spacing_m.x);
  EXPECT_NEAR(file->dy_m, spacing_m.y, 0.01 * spacing_m.y);
  if (absl::StartsWith(GetParam().set, "hrrr")) {
    EXPECT_EQ(glm::dvec2(file->cells), Columns());
  } else {
    // Columns in degrees are resampled to a rectangle around all of them.
    EXPECT_NEAR(file->cells.x, Columns().x, 2.0);
    EXPECT_NEAR(file->cells.y, Columns().y, 2.0);
  }
  EXPECT_THAT(file->assumptions, ::testing::Not(::testing::IsEmpty()));
}

TEST_P(GribTruth, MaximaAndTheirPlaces) {
  const auto storm = StormOf(time_);
  const auto source = OpenGribTime(storm, 0);
  ASSERT_TRUE(source.ok()) << source.status();
  const LayerDomain& domain = (*source)->Domain();
  const auto interfaces_m = (*source)->InterfaceHeights_m();
  ASSERT_TRUE(interfaces_m.ok()) << interfaces_m.status();
  std::size_t found = 0;
  const auto check = [&](const std::string& name, const std::vector<float>& values) {
    ASSERT_TRUE(time_.truth["hydrometeor_max"].contains(name)) << name;
    const json& truth = time_.truth["hydrometeor_max"][name];
    ++found;
    const std::size_t layer = LayerOf(storm->contents.times[0], truth["level"]);
    const std::size_t column =
        truth["j"].get<std::size_t>() * domain.cells.x + truth["i"].get<std::size_t>();
    const double maximum = truth["max"];
    // The known maximum is that of the values before they were packed, which rounds them.
    constexpr double kPacking = 0.01;
    float highest = 0.0F;
    for (const float value : values) highest = std::max(highest, std::isnan(value) ? 0.0F : value);
    EXPECT_NEAR(highest, maximum, kPacking * maximum) << name;
    EXPECT_NEAR(values[layer * domain.Columns() + column], maximum, kPacking * maximum) << name;
    const double low_m = (*interfaces_m)[layer * domain.Columns() + column];
    const double high_m = (*interfaces_m)[(layer + 1) * domain.Columns() + column];
    const double height_m = truth["height_asl_m"];
    EXPECT_LT(low_m, height_m) << name;
    EXPECT_GT(high_m, height_m) << name;
  };
  for (std::size_t i = 0; i < domain.fields.size(); ++i) {
    const auto amounts = (*source)->Amounts(i);
    ASSERT_TRUE(amounts.ok()) << amounts.status();
    std::string name = domain.fields[i].variable;
    if (name.starts_with("Q")) std::ranges::transform(name, name.begin(), ::tolower);
    check(name, amounts->amounts);
    if (!domain.fields[i].sizes.name.empty()) check(domain.fields[i].sizes.name, amounts->sizes);
  }
  EXPECT_EQ(found, time_.truth["hydrometeor_max"].size());
}

TEST_P(GribTruth, HeightsOfLevels) {
  const auto storm = StormOf(time_);
  const auto source = OpenGribTime(storm, 0);
  ASSERT_TRUE(source.ok()) << source.status();
  const auto interfaces_m = (*source)->InterfaceHeights_m();
  ASSERT_TRUE(interfaces_m.ok()) << interfaces_m.status();
  const GribLayers& layers = storm->contents.times[0];
  const std::size_t columns = storm->contents.grid.Points();
  for (const json& truth : time_.truth["columns"]) {
    const std::size_t column = truth["j"].get<std::size_t>() * storm->contents.grid.columns +
                               truth["i"].get<std::size_t>();
    std::vector<double> heights_m(layers.levels.size(), std::nan(""));
    for (std::size_t i = 0; i < truth["levels"].size(); ++i) {
      const double level = truth["levels"][i];
      const double wanted = layers.vertical == GribVertical::kIsobaric ? 100.0 * level : level;
      const bool is_read = std::ranges::any_of(
          layers.levels, [&](double each) { return std::abs(each - wanted) < 1e-3; });
      if (is_read) heights_m[LayerOf(layers, level)] = truth["heights_asl_m"][i];
    }
    const double ground_m = truth["surface_height_m"];
    EXPECT_NEAR((*interfaces_m)[column], ground_m, 1.0);
    std::size_t checked = 0;
    for (std::size_t i = 0; i < heights_m.size(); ++i) {
      const double low_m = (*interfaces_m)[i * columns + column];
      const double high_m = (*interfaces_m)[(i + 1) * columns + column];
      if (low_m == high_m) {
        // The level is below the ground.
        EXPECT_LT(heights_m[i], ground_m);
        continue;
      }
      const bool is_half_way =
          layers.vertical == GribVertical::kHeights || layers.vertical == GribVertical::kIsobaric;
      const double tolerance_m = std::max(10.0, 0.01 * heights_m[i]);
      if (!is_half_way) {
        EXPECT_NEAR((low_m + high_m) / 2.0, heights_m[i], tolerance_m) << i;
      } else if (i > 0 && heights_m[i - 1] > ground_m) {
        EXPECT_NEAR(low_m, (heights_m[i - 1] + heights_m[i]) / 2.0, tolerance_m) << i;
      }
      ++checked;
    }
    EXPECT_GT(checked, heights_m.size() - 4);
  }
}

TEST_P(GribTruth, WaterPathsAndTheStrongestColumn) {
  const auto file = Describe(time_);
  ASSERT_TRUE(file.ok()) << file.status();
  const auto fields = file->reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  const std::size_t columns = static_cast<std::size_t>(file->cells.x) * file->cells.y;
  std::vector<double> paths(columns, 0.0);
  for (const volume::HydrometeorField& field : fields->fields) {
    for (std::size_t i = 0; i < field.concentration_kg_per_m3.size(); ++i) {
      paths[i % columns] += field.concentration_kg_per_m3[i] * fields->grid.spacing_m.z;
    }
  }
  const bool from_file = time_.truth.contains("column_max_from_file");
  const json& truth = time_.truth[from_file ? "column_max_from_file" : "column_max"];
  const auto strongest = static_cast<std::size_t>(std::ranges::max_element(paths) - paths.begin());
  const auto map =
      volume::MapProjection::Of(file->projection, {*file->latitude_deg, *file->longitude_deg});
  ASSERT_TRUE(map.ok()) << map.status();
  const auto expected_m = map->WorldOf({truth["lat"].get<double>(), truth["lon"].get<double>()});
  ASSERT_TRUE(expected_m.has_value());
  const glm::dvec2 position =
      *expected_m / glm::dvec2(file->dx_m, file->dy_m) + 0.5 * (glm::dvec2(file->cells) - 1.0);
  const std::size_t column = strongest % file->cells.x;
  const std::size_t row = strongest / file->cells.x;
  EXPECT_NEAR(column, position.x, 1.0);
  EXPECT_NEAR(row, position.y, 1.0);
  const double path = truth["condensate_kg_m2"];
  EXPECT_NEAR(paths[strongest], path, 0.025 * path);
  // Resampled columns may cover more than the domain, so water is compared with that of its area.
  const double water_kg =
      std::accumulate(paths.begin(), paths.end(), 0.0) * file->dx_m * file->dy_m;
  const double known_kg = truth["domain_mean_kg_m2"].get<double>() * Area_m2();
  EXPECT_NEAR(water_kg, known_kg, 0.025 * known_kg);
}

// The sets that have wind.
class GribWind : public GribTruth {};
INSTANTIATE_TEST_SUITE_P(Sets, GribWind,
                         ::testing::Values(Case{"HrrrNative1", "hrrr-native", 1},
                                           Case{"HrrrPressure", "hrrr-pressure", 0}),
                         [](const auto& parameter) { return parameter.param.name; });

TEST_P(GribWind, IsAlongTheGrid) {
  const auto storm = StormOf(time_);
  const auto source = OpenGribTime(storm, 0);
  ASSERT_TRUE(source.ok()) << source.status();
  const auto wind = (*source)->Wind();
  ASSERT_TRUE(wind.ok()) << wind.status();
  ASSERT_FALSE(wind->u_m_per_s.empty());
  json all = time_.truth["wind_in_max_column"];
  if (!all.is_array()) all = json::array({all});
  for (const json& truth : all) {
    const std::size_t columns = storm->contents.grid.Points();
    const std::size_t at = LayerOf(storm->contents.times[0], truth["level"]) * columns +
                           truth["j"].get<std::size_t>() * storm->contents.grid.columns +
                           truth["i"].get<std::size_t>();
    // Packed in steps of 1/16 m/s, and the vertical wind in Pa/s.
    EXPECT_NEAR(wind->u_m_per_s[at], truth["along_grid_u"].get<double>(), 0.1);
    EXPECT_NEAR(wind->v_m_per_s[at], truth["along_grid_v"].get<double>(), 0.1);
    const double ascent = truth["w"];
    EXPECT_NEAR(wind->w_m_per_s[at], ascent, std::max(0.1, 0.02 * std::abs(ascent)));
  }
}

// The lowest pressure levels are below the ground, and the steering wind begins above them.
TEST_P(GribWind, SteersDetail) {
  const auto file = Describe(time_);
  ASSERT_TRUE(file.ok()) << file.status();
  const auto fields = file->reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(fields->motion.steering_m_per_s.x, 4.5, 2.0);
  EXPECT_NEAR(fields->motion.steering_m_per_s.y, 2.2, 1.0);
}

// The wind is known both along the grid and along east and north.
TEST_P(GribWind, TurnsWithTheGrid) {
  const auto storm = StormOf(time_);
  const auto angles = AxisAngles(storm->contents.grid);
  ASSERT_TRUE(angles.ok()) << angles.status();
  json truth = time_.truth["wind_in_max_column"];
  if (truth.is_array()) truth = truth[0];
  const float angle = (*angles)[truth["j"].get<std::size_t>() * storm->contents.grid.columns +
                                truth["i"].get<std::size_t>()];
  const double east = truth["earth_east"];
  const double north = truth["earth_north"];
  EXPECT_NEAR(east * std::cos(angle) + north * std::sin(angle), truth["along_grid_u"].get<double>(),
              0.01);
  EXPECT_NEAR(north * std::cos(angle) - east * std::sin(angle), truth["along_grid_v"].get<double>(),
              0.01);
}

// Without the heights of half levels, the heights of ICON's levels are not known.
TEST(GribParts, NameWhatIsMissing) {
  const StormFormats formats = StormFormats::BuiltIn();
  Time time = TimeOf("icon-d2-like", 0);
  const auto without = [&](const std::string& text) {
    std::vector<std::string> paths = time.paths;
    std::erase_if(paths, [&](const std::string& path) { return absl::StrContains(path, text); });
    EXPECT_LT(paths.size(), time.paths.size()) << text;
    return std::string(formats.DescribeTogether(paths).status().message());
  };
  EXPECT_THAT(without("_hhl."), HasSubstr("HHL, 0/3/6"));
  EXPECT_THAT(without("_000_30_hhl."), HasSubstr("HHL (0/3/6) of half level 30 is missing"));
  EXPECT_THAT(without("_001_30_qr."),
              HasSubstr("QR (0/1/24) of generalized level 30 is missing at 2024-05-20 22:00 UTC"));
  EXPECT_THAT(without("_001_30_"), HasSubstr("every field of generalized level 30 is missing"));
  EXPECT_THAT(without("_001_65_"), HasSubstr("every field of generalized level 65 is missing"));
  EXPECT_THAT(without("_t."), HasSubstr("temperature (0/0/0) is missing"));
}

TEST(GribParts, SayOfWhichTimeTheyAre) {
  const StormFormats formats = StormFormats::BuiltIn();
  const Time time = TimeOf("icon-d2-like", 1);
  std::set<std::string> of;
  for (const std::string& path : time.paths) {
    const auto file = formats.Describe(path);
    ASSERT_TRUE(file.ok()) << file.status();
    of.insert(file->part.of);
    EXPECT_EQ(file->part.at_all_times, absl::StrContains(path, "_hhl."));
    EXPECT_EQ(file->times.empty(), file->part.at_all_times);
    if (file->times.empty()) continue;
    EXPECT_EQ(file->times[0], ParsedTime(time.truth["valid_time"]));
  }
  EXPECT_EQ(of.size(), 1U);
  EXPECT_NE(*of.begin(), "");
}

}  // namespace
}  // namespace thunderhead::storm_files
