// Tests of storms in GRIB files: genuine files of weather centres, and small files written here
// whose fields, levels, runs or members do not fit together.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/byte_source.h"
#include "glm/geometric.hpp"
#include "storm_files/grib_air.h"
#include "storm_files/grib_parts.h"
#include "storm_files/grib_storm.h"
#include "storm_files/storm_format.h"
#include "storm_store/storm_catalogue.h"
#include "storm_store/storm_store.h"
#include "tests/support/earth_formulas.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/grib/messages.h"
#include "tests/unit/storm_files/cell_meshes.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {
namespace {

using grib::testing::BytesOf;
using grib::testing::GridOf;
using grib::testing::LatLon;
using grib::testing::Message;
using physics::Hydrometeor;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string Real(const std::string& name) {
  return (std::filesystem::path(THUNDERHEAD_SOURCE_DIR).parent_path() / "shared/data/real" / name)
      .string();
}

std::string ErrorOf(const absl::StatusOr<StormFile>& file) {
  return std::string(file.status().message());
}

absl::StatusOr<StormFile> DescribeAlone(const std::string& path) {
  const StormFormats formats = StormFormats::BuiltIn();
  auto file = formats.Describe(path);
  if (!file.ok() || file->part.of.empty()) return file;
  return formats.DescribeTogether({path});
}

// GFS of 2011: one variable for liquid and ice, relative humidity, wind in shared messages.
TEST(GenuineGrib, ReadsAnOldGfs) {
  const auto file = DescribeAlone(Real("pygrib_gfs.t12z.pgrbf120.2p5deg.grib2"));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->cells, glm::ivec3(144, 73, 21));
  EXPECT_THAT(file->fields, ElementsAre(Hydrometeor::kCloud, Hydrometeor::kIce));
  EXPECT_THAT(file->assumptions,
              ::testing::IsSupersetOf({HasSubstr("CLMR holds liquid and ice"),
                                       HasSubstr("relative humidity over water"),
                                       HasSubstr("kg per kg of the whole air")}));
  EXPECT_EQ(file->about, "NCEP GFS");
  EXPECT_EQ(file->times.front() - *file->run_start, absl::Hours(120));
  const auto fields = file->reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  // The maximum of both phases together is 1.118e-3 at 350 hPa, where ice dominates.
  EXPECT_LE(fields->fields[0].statistics.maximum, 1.118e-3F);
  EXPECT_GT(fields->fields[1].statistics.maximum, 0.5e-3F);
  EXPECT_LE(fields->fields[1].statistics.maximum, 1.118e-3F);
  EXPECT_EQ(fields->fields[1].variable, "CLMR");
  EXPECT_FALSE(fields->motion.ascent.empty());
}

TEST(GenuineGrib, NamesWhatOthersLack) {
  EXPECT_THAT(ErrorOf(DescribeAlone(Real("earthkit_ml_data.grib"))),
              HasSubstr("has no field of cloud water (0/1/22"));
  EXPECT_THAT(ErrorOf(DescribeAlone(Real("earthkit_test_icon.grib"))), HasSubstr("has no field"));
}

// A storm on hybrid levels, level 1 lowest, of HRRR's layout. Every field has one value on each
// level, except for cloud water, whose western column has twice as much.
struct Layout {
  int centre = 7;
  int process = 83;
  int levels = 4;
  int member = -1;
  int hour = 21;
  int forecast = 1;
  int level_type = 105;
  LatLon grid;
  // Changes or drops (false) a field.
  std::function<bool(Message&)> edit = [](Message&) { return true; };
};

std::string FileOf(const Layout& layout) {
  std::string bytes;
  const auto add = [&](int category, int number, int type, int level, std::vector<float> values,
                       float minimum, float step) {
    Message message;
    message.category = category;
    message.number = number;
    message.centre = layout.centre;
    message.process = layout.process;
    message.member = layout.member;
    message.hour = layout.hour;
    message.forecast = layout.forecast;
    message.level = {type, level};
    message.grid = GridOf(layout.grid);
    message.points = std::int64_t{layout.grid.columns} * layout.grid.rows;
    message.values = std::move(values);
    message.minimum = minimum;
    message.step = step;
    if (layout.edit(message)) bytes += BytesOf(message);
  };
  for (int level = 1; level <= layout.levels; ++level) {
    const auto height = static_cast<float>(1000 * level);
    const int type = layout.level_type;
    add(3, 5, type, level, {height}, 0.0F, 1.0F);
    add(3, 0, type, level, {100'000.0F - 10.0F * height}, 0.0F, 1.0F);
    add(0, 0, type, level, {280.0F}, 0.0F, 1.0F);
    add(1, 0, type, level, {0.0F}, 0.0F, 1.0F);
    const float step = std::exp2(-14.0F);
    add(1, 22, type, level, {16 * step, 8 * step, 16 * step, 8 * step}, 0.0F, step);
    add(1, 24, type, level, {8 * step}, 0.0F, step);
  }
  add(3, 5, 1, 0, {400.0F}, 0.0F, 1.0F);
  add(3, 0, 1, 0, {99'000.0F}, 0.0F, 1.0F);
  return bytes;
}

class GribStormTest : public ::testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& bytes) {
    const std::string path = folder_.File(name);
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  absl::StatusOr<StormFile> Describe(const Layout& layout) {
    return DescribeAlone(Write("storm.grib2", FileOf(layout)));
  }
  std::string ErrorWith(std::function<bool(Message&)> edit, Layout layout = {}) {
    layout.edit = std::move(edit);
    const auto file = Describe(layout);
    if (!file.ok()) return ErrorOf(file);
    return std::string(file->reader->Read(0, std::nullopt, {}).status().message());
  }

  testing::TemporaryFolder folder_;
};

// If a model moves its grid along with a storm, all files belong to one run and one grid. Each file
// has its own map projection and its own spacing of columns in metres.
TEST_F(GribStormTest, AGridThatMovesIsOneStorm) {
  Layout layout;
  const auto first = Describe(layout);
  layout.forecast = 2;
  layout.grid.first_latitude += 5'000'000;
  layout.grid.first_longitude -= 2'000'000;
  const auto second = Describe(layout);
  ASSERT_TRUE(first.ok() && second.ok()) << first.status() << second.status();
  EXPECT_EQ(first->run, second->run);
  EXPECT_EQ(first->grid, second->grid);
  EXPECT_FALSE(first->grid.empty());
  EXPECT_NEAR(*second->latitude_deg - *first->latitude_deg, 5.0, 1e-6);
  EXPECT_NE(first->projection, second->projection);
  EXPECT_LT(second->dx_m, 0.99 * first->dx_m);
  layout.grid.step *= 2;
  EXPECT_NE(Describe(layout)->grid, first->grid);
}

bool Is(const Message& message, int category, int number, int level, int type = 105) {
  return message.category == category && message.number == number && message.level.value == level &&
         message.level.type == type;
}

double PathAt(const volume::HydrometeorFields& fields, std::size_t field, std::size_t column) {
  const std::size_t columns = static_cast<std::size_t>(fields.grid.cells.x) * fields.grid.cells.y;
  double path = 0.0;
  const auto& values = fields.fields[field].concentration_kg_per_m3;
  for (std::size_t i = column; i < values.size(); i += columns) {
    path += values[i] * fields.grid.spacing_m.z;
  }
  return path;
}

TEST_F(GribStormTest, ReadsAWholeFile) {
  const auto file = Describe({});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->cells, glm::ivec3(2, 2, 4));
  EXPECT_EQ(file->about, "NCEP HRRR");
  EXPECT_EQ(file->run_start, absl::FromUnixSeconds(1716238800));  // 2024-05-20 21:00 UTC
  EXPECT_THAT(file->fields, ElementsAre(Hydrometeor::kCloud, Hydrometeor::kRain));
  EXPECT_THAT(file->assumptions, Contains(HasSubstr("kg per kg of dry air")));
  EXPECT_EQ(file->member, "");
  const auto fields = file->reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ(fields->terrain_height_m[0], 400.0F);
  // Interfaces are at 400, 1500, 2500, 3500 and 4500 m, and pressure is 900 to 600 hPa at 280 K.
  constexpr double kGas = 287.0;
  const double mass =
      (90'000.0 * 1100 + 80'000.0 * 1000 + 70'000.0 * 1000 + 60'000.0 * 1000) / (kGas * 280.0);
  EXPECT_NEAR(PathAt(*fields, 0, 0), mass * 16 / 16384, 0.002 * mass * 16 / 16384);
  EXPECT_NEAR(PathAt(*fields, 0, 1), PathAt(*fields, 0, 0) / 2, 1e-3 * mass * 16 / 16384);
  EXPECT_NEAR(PathAt(*fields, 1, 0), mass * 8 / 16384, 0.002 * mass * 8 / 16384);
}

// Air temperatures must be from 100 to 400 K. If a level has other temperatures, its cells are
// missing.
TEST_F(GribStormTest, LeavesOutImpossibleTemperatures) {
  Layout layout;
  layout.edit = [](Message& message) {
    if (Is(message, 0, 0, 2)) message.values = {2000.0F};
    // The level has no water, so none is lost.
    if (Is(message, 1, 22, 2) || Is(message, 1, 24, 2)) message.values = {0.0F};
    return true;
  };
  const auto file = Describe(layout);
  ASSERT_TRUE(file.ok()) << file.status();
  const auto fields = file->reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ(fields->fields[0].statistics.missing_cells, 4);
  const double mass = (90'000.0 * 1100 + 70'000.0 * 1000 + 60'000.0 * 1000) / (287.0 * 280.0);
  EXPECT_NEAR(PathAt(*fields, 0, 0), mass * 16 / 16384, 0.002 * mass * 16 / 16384);
  EXPECT_THAT(ErrorWith([](Message& message) {
                if (message.category == 0) message.values = {2000.0F};
                return true;
              }),
              HasSubstr("of record 0 give no usable air density"));
  EXPECT_THAT(ErrorWith([](Message& message) {
                if (Is(message, 0, 0, 2)) message.values = {2000.0F};
                return true;
              }),
              HasSubstr("% of CLMR of record 0 is in cells whose air is missing or impossible"));
}

// Humidity in g/kg. All of it is above 1 kg/kg if it is read as GRIB's unit.
TEST_F(GribStormTest, RefusesMoreVapourThanAirCanHold) {
  for (const int number : {0, 2}) {
    EXPECT_THAT(ErrorWith([number](Message& message) {
                  if (message.category == 1 && message.number == 0) {
                    message.number = number;
                    message.values = {10.0F};
                  }
                  return true;
                }),
                HasSubstr("of record 0 gives 10 kg of vapour per kg of dry air, more than air"));
  }
}

// NCEP's numbers of processes name the model, and so the air to which mixing ratios refer.
TEST_F(GribStormTest, TheProcessTellsTheAirOfMixingRatios) {
  struct Case {
    int process;
    std::string about;
    std::string assumption;
  };
  for (const Case& each :
       {Case{83, "NCEP HRRR", "kg per kg of dry air, because the WRF model, which HRRR"},
        Case{116, "NCEP WRF-ARW", "kg per kg of dry air, because the WRF model writes them so"},
        Case{96, "NCEP GFS",
             "of the whole air (dry air, vapour and condensate), because the FV3 model"},
        Case{134, "NCEP RRFS",
             "of the whole air (dry air, vapour and condensate), because the FV3 model"},
        Case{84, "NCEP",
             "because the parameter's definition says so, and the model is not known"}}) {
    const auto file = Describe({.process = each.process});
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(file->about, each.about);
    EXPECT_THAT(file->assumptions, ::testing::Contains(HasSubstr(each.assumption)));
  }
}

TEST_F(GribStormTest, RefusesLatitudesBeyondThePoles) {
  Layout layout;
  layout.grid.first_latitude = 92'000'000;
  const auto file = Describe(layout);
  ASSERT_FALSE(file.ok());
  EXPECT_THAT(ErrorOf(file), HasSubstr("its grid reaches beyond a pole"));
}

// If a file has its rows from north to south, they are read from south to north.
TEST_F(GribStormTest, RowsRunNorthwards) {
  Layout layout;
  layout.edit = [](Message& message) {
    // The southern row, which is the last in the file, has twice the amount of the northern row.
    if (message.number == 22) {
      message.values = {8 * message.step, 8 * message.step, 16 * message.step, 16 * message.step};
    }
    return true;
  };
  layout.grid.scanning = 0;
  const auto file = Describe(layout);
  ASSERT_TRUE(file.ok()) << file.status();
  const auto fields = file->reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(PathAt(*fields, 0, 0), 2.0 * PathAt(*fields, 0, 2), 1e-4);
  EXPECT_NEAR(PathAt(*fields, 0, 0), PathAt(*fields, 0, 1), 1e-6);
}

TEST_F(GribStormTest, RunsAndMembersDiffer) {
  const auto first = Describe({});
  const auto later = Describe({.hour = 22});
  const auto centre = Describe({.centre = 98});
  const auto member = Describe({.member = 5});
  ASSERT_TRUE(first.ok() && later.ok() && centre.ok() && member.ok());
  EXPECT_NE(first->run, later->run);
  EXPECT_NE(first->run, centre->run);
  EXPECT_EQ(member->member, "mem05");
  EXPECT_EQ(first->run, Describe({.forecast = 3})->run);
}

TEST_F(GribStormTest, ReadsSeveralTimes) {
  const auto file = DescribeAlone(
      Write("times.grib2", FileOf({.forecast = 2}) + FileOf({}) + FileOf({.forecast = 3})));
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->times.size(), 3U);
  EXPECT_EQ(file->times[0] + absl::Hours(1), file->times[1]);
  EXPECT_TRUE(file->reader->Read(2, std::nullopt, {}).ok());
}

// Returns a layout with cloud water of `amount` times 2^-14 kg per kg at all points.
Layout WithCloud(float amount, Layout layout = {}) {
  layout.edit = [amount](Message& message) {
    if (message.category == 1 && message.number == 22) message.values = {amount * message.step};
    return true;
  };
  return layout;
}

// Returns the names of the storms, each with its path of cloud water at the first time relative to
// `amount` of WithCloud.
std::vector<std::pair<std::string, double>> CloudIn(const std::string& path,
                                                    const StormFormats& formats) {
  std::vector<std::pair<std::string, double>> storms;
  const auto store = storm_store::StormStore::Open({path}, {.read_ahead = 0, .formats = formats});
  if (!store.ok()) return {{std::string(store.status().message()), 0.0}};
  constexpr double kOfOne = (90'000.0 * 1100 + 210'000.0 * 1000) / (287.0 * 280.0);
  for (const storm_store::StormInfoPtr& storm : (*store)->Storms()) {
    const auto fields = (*store)->Get(storm->id, 0, {});
    storms.emplace_back(storm->id, fields.ok() ? PathAt(**fields, 0, 0) * 16384 / kOfOne : -1.0);
  }
  return storms;
}

auto Storm(const std::string& id, double amount) {
  return ::testing::Pair(id, ::testing::DoubleNear(amount, 0.01 * amount));
}

TEST_F(GribStormTest, EachMemberInAFileIsAStorm) {
  const std::string path =
      Write("eps", FileOf(WithCloud(3, {.member = 2})) + FileOf(WithCloud(5, {.member = 1})) +
                       FileOf(WithCloud(7, {.member = 1, .forecast = 2})));
  EXPECT_THAT(CloudIn(path, StormFormats::BuiltIn()),
              ElementsAre(Storm("eps-mem01", 5), Storm("eps-mem02", 3)));
  EXPECT_THAT(CloudIn(folder_.Path().string(), StormFormats::BuiltIn()),
              ElementsAre(Storm("eps-mem01", 5), Storm("eps-mem02", 3)));
  EXPECT_THAT(CloudIn(path + "/mem02", StormFormats::BuiltIn()),
              ElementsAre(Storm("eps-mem02", 3)));
  EXPECT_THAT(CloudIn(path + "/mem03", StormFormats::BuiltIn()),
              ElementsAre(::testing::Pair(
                  HasSubstr("eps/mem03: there is no such storm in the file; it has "), 0.0)));
}

// A server may be given one storm of a file, too.
TEST_F(GribStormTest, AServerFindsTheMemberOfAFile) {
  const std::string path =
      Write("eps", FileOf(WithCloud(3, {.member = 2})) + FileOf(WithCloud(5, {.member = 1})));
  const auto open = [](const std::string& data) {
    storm_store::StormStoreOptions options;
    options.read_ahead = 0;
    options.live = storm_store::LiveCatalogueOptions{.settle = std::chrono::milliseconds(0)};
    return storm_store::StormStore::Open({data}, options);
  };
  const auto store = open(path + "/mem02");
  ASSERT_TRUE(store.ok()) << store.status();
  ASSERT_EQ((*store)->Storms().size(), 1U);
  EXPECT_EQ((*store)->Storms().front()->id, "eps-mem02");
  EXPECT_TRUE((*store)->Get("eps-mem02", 0, {}).ok());
  // The file lies where the server may read.
  EXPECT_TRUE(storm_store::CheckPlace({path + "/mem02"}, {}, path, path).ok());
  EXPECT_THAT(
      std::string(open(path + "/mem03").status().message()),
      HasSubstr("no such storm in the file; it has " + path + "/mem01, " + path + "/mem02"));
  EXPECT_EQ(open(path + "x/mem03").status().code(), absl::StatusCode::kNotFound);
}

// A file that lacks a field of a whole storm looks like one of several files of a time.
TEST_F(GribStormTest, AFileThatIsNotWholeSaysWhatItHasAndLacks) {
  const auto error_without = [this](int category, std::vector<int> numbers) {
    const std::string path =
        Write("storm.grib2", FileOf({.edit = [&](Message& message) {
                return message.category != category ||
                       std::ranges::find(numbers, message.number) == numbers.end();
              }}));
    const auto store = storm_store::StormStore::Open({path}, {.read_ahead = 0});
    EXPECT_EQ(store.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(store.status().message());
  };
  EXPECT_THAT(error_without(0, {0}),
              HasSubstr("storm.grib2: holds only a part of a storm: it has geopotential height "
                        "(0/3/5) on 5 levels, pressure (0/3/0) on 5 levels, specific humidity "
                        "(0/1/0) on 4 levels, cloud (0/1/22) on 4 levels and rain (0/1/24) on 4 "
                        "levels, and no temperature (0/0/0) on two levels; add what is missing"));
  EXPECT_THAT(error_without(1, {22, 24}), HasSubstr("and no hydrometeors (0/1/22, "));
}

TEST_F(GribStormTest, ForecastTimesInMonthsAreRefused) {
  const auto with_unit = [](int unit) {
    return [unit](Message& message) {
      message.unit = unit;
      return true;
    };
  };
  EXPECT_THAT(ErrorWith(with_unit(3)),
              HasSubstr("the field 0/3/5 in the GRIB message at byte 0 has its forecast time in "
                        "months, whose lengths differ (code table 4.4, unit 3); give it in hours"));
  EXPECT_THAT(ErrorWith(with_unit(5)), HasSubstr("in years, whose lengths differ"));
  EXPECT_THAT(ErrorWith(with_unit(200)), HasSubstr("in a unit that is not known"));
}

TEST_F(GribStormTest, EachRunInAFileIsAStorm) {
  Write("runs",
        FileOf(WithCloud(3, {.hour = 21})) + FileOf(WithCloud(5, {.hour = 18, .forecast = 4})));
  EXPECT_THAT(CloudIn(folder_.Path().string(), StormFormats::BuiltIn()),
              ElementsAre(Storm("runs-2024-05-20T18-00", 5), Storm("runs-2024-05-20T21-00", 3)));
}

// Files of several times that hold all members continue each member.
TEST_F(GribStormTest, MembersGoOnInTheNextFile) {
  for (const int forecast : {1, 2, 3}) {
    Write(absl::StrCat("f", forecast),
          FileOf(WithCloud(3, {.member = 1, .forecast = forecast})) +
              FileOf(WithCloud(5, {.member = 2, .forecast = forecast})));
  }
  const auto storms = CloudIn(folder_.Path().string(), StormFormats::BuiltIn());
  const std::string name = folder_.Path().filename().string();
  EXPECT_THAT(storms, ElementsAre(Storm(name + "-mem01", 3), Storm(name + "-mem02", 5)));
}

// A field without a member is shared, unless a storm without a member is in the file.
TEST_F(GribStormTest, MembersShareWhatHasNoMember) {
  const auto only = [](bool members, Layout layout) {
    const auto edit = layout.edit;
    layout.edit = [=](Message& message) {
      return edit(message) && (message.category == 1 && message.number > 0) == members;
    };
    return FileOf(layout);
  };
  const std::string shared = only(false, {});
  Write("shared",
        only(true, WithCloud(3, {.member = 1})) + shared + only(true, WithCloud(5, {.member = 2})));
  EXPECT_THAT(CloudIn(folder_.Path().string(), StormFormats::BuiltIn()),
              ElementsAre(Storm("shared-mem01", 3), Storm("shared-mem02", 5)));
  Write("shared", FileOf(WithCloud(7)) + FileOf(WithCloud(5, {.member = 2})));
  EXPECT_THAT(CloudIn(folder_.Path().string(), StormFormats::BuiltIn()),
              ElementsAre(Storm("shared", 7), Storm("shared-mem02", 5)));
}

TEST_F(GribStormTest, NamesTheMemberThatIsIncomplete) {
  Layout cut = {.member = 2};
  cut.edit = [](Message& message) { return !Is(message, 1, 24, 3); };
  EXPECT_THAT(ErrorOf(DescribeAlone(Write("b", FileOf({.member = 1}) + FileOf(cut)))),
              HasSubstr("b (run 2024-05-20 21:00 UTC, mem02): RWMR (0/1/24) of hybrid level 3 is "
                        "missing"));
  EXPECT_THAT(ErrorOf(DescribeAlone(Write("c", FileOf({}) + FileOf({})))),
              HasSubstr("is there twice at hybrid level 1"));
  // The temperature of another run must not be used for this run.
  const std::string other =
      FileOf({.hour = 18, .edit = [](Message& message) { return message.category == 0; }});
  EXPECT_THAT(ErrorOf(DescribeAlone(Write("a", FileOf({}) + other))),
              HasSubstr("has fields of several runs (2024-05-20 21:00 UTC of centre 7, and "
                        "2024-05-20 18:00 UTC of centre 7)"));
}

// Files of other times may tell that a file was cut between two levels.
TEST_F(GribStormTest, StatesThatOtherTimesHaveMoreLevels) {
  Write("f1", FileOf({}));
  Write("f2", FileOf({.forecast = 2}));
  Write("f3", FileOf({.levels = 3, .forecast = 3}));
  const auto store = storm_store::StormStore::Open({folder_.Path().string()}, {.read_ahead = 0});
  ASSERT_TRUE(store.ok()) << store.status();
  const std::string note =
      "This file has 3 layers, and others of its run have 4: it may have been "
      "cut short.";
  EXPECT_THAT((*store)->Find("f3")->assumptions, Contains(note));
  for (const storm_store::StormInfoPtr& storm : (*store)->Storms()) {
    if (storm->id == "f3") continue;
    EXPECT_THAT(storm->assumptions, ::testing::Not(Contains(note)));
  }
  EXPECT_EQ((*store)->Find("f3")->run_start, "2024-05-20T21:00:00Z");
}

TEST_F(GribStormTest, NamesMissingLevels) {
  const auto without = [this](int category, int number, int level) {
    return ErrorWith([=](Message& message) { return !Is(message, category, number, level); });
  };
  EXPECT_THAT(without(1, 24, 3), HasSubstr("RWMR (0/1/24) of hybrid level 3 is missing at "
                                           "2024-05-20 22:00 UTC"));
  EXPECT_THAT(without(1, 22, 1), HasSubstr("CLMR (0/1/22) of hybrid level 1 is missing"));
  EXPECT_THAT(without(0, 0, 2), HasSubstr("TMP (0/0/0) of hybrid level 2 is missing"));
  EXPECT_THAT(without(1, 0, 4), HasSubstr("SPFH (0/1/0) of hybrid level 4 is missing"));
  EXPECT_THAT(without(3, 5, 2), HasSubstr("HGT (0/3/5) of hybrid level 2 is missing"));
  EXPECT_THAT(without(3, 0, 4), HasSubstr("PRES (0/3/0) of hybrid level 4 is missing"));
  EXPECT_THAT(ErrorWith([](Message& message) { return message.level.value != 2; }),
              HasSubstr("every field of hybrid level 2 is missing"));
  EXPECT_THAT(ErrorWith([](Message& message) { return message.level.value != 1; }),
              HasSubstr("every field of the levels below level 2 is missing"));
}

// A file that was cut between two messages may have the first fields of its last level.
TEST_F(GribStormTest, NamesALevelThatOnlyOtherFieldsHave) {
  const auto only = [this](int category, int number) {
    return ErrorWith([=](Message& message) {
      return message.level.value != 4 || Is(message, category, number, 4);
    });
  };
  EXPECT_THAT(only(3, 0), HasSubstr("CLMR (0/1/22) of hybrid level 4 is missing at "
                                    "2024-05-20 22:00 UTC; get the complete set of fields"));
  EXPECT_THAT(only(3, 5), HasSubstr("CLMR (0/1/22) of hybrid level 4 is missing"));
  EXPECT_THAT(only(0, 0), HasSubstr("CLMR (0/1/22) of hybrid level 4 is missing"));
  EXPECT_THAT(only(1, 0), HasSubstr("CLMR (0/1/22) of hybrid level 4 is missing"));
  EXPECT_THAT(only(1, 24), HasSubstr("CLMR (0/1/22) of hybrid level 4 is missing"));
}

// The coefficients of hybrid levels say how many levels there are, also if heights are given.
TEST_F(GribStormTest, NamesALevelThatOnlyCoefficientsHave) {
  const auto error = [this](std::vector<float> coefficients) {
    return ErrorWith([&](Message& message) {
      message.coordinates = coefficients;
      return true;
    });
  };
  const std::vector<float> of_four = {0.0F, 0.0F, 1e3F, 1e3F, 5e3F, 1.0F, 0.7F, 0.5F, 0.2F, 0.0F};
  EXPECT_EQ(error(of_four), "");
  std::vector<float> of_five = of_four;
  of_five.insert(of_five.begin(), 0.0F);
  of_five.push_back(0.0F);
  EXPECT_THAT(error(of_five), HasSubstr("every field of hybrid level 5 is missing"));
  // Other models write other numbers in place of coefficients. These numbers do not say how many
  // levels there are.
  of_five.back() = 273.15F;
  EXPECT_EQ(error(of_five), "");
}

TEST_F(GribStormTest, StatesWhyWindAndNumbersAreLeftOut) {
  Layout layout;
  std::string more;
  const auto add = [&](int category, int number, int level) {
    more += BytesOf({.category = category,
                     .number = number,
                     .level = {105, level},
                     .grid = GridOf({}),
                     .points = 4,
                     .values = {1.0F}});
  };
  for (int level = 1; level <= 4; ++level) {
    if (level < 4) add(2, 2, level);
    add(2, 3, level);
    if (level != 2) add(1, 100, level);
  }
  const auto file = DescribeAlone(Write("more", FileOf(layout) + more));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(
      file->assumptions,
      ::testing::IsSupersetOf({"UGRD (0/2/2) is not used, because hybrid level 4 is missing at "
                               "2024-05-20 22:00 UTC.",
                               "SPNCR (0/1/100) is not used, because hybrid level 2 is missing at "
                               "2024-05-20 22:00 UTC."}));
  EXPECT_THAT(file->assumptions, ::testing::Not(Contains(HasSubstr("VGRD"))));
}

// The ground has the colours of NCEP's vegetation types, as that of WRF files has.
TEST_F(GribStormTest, ReadsTheLand) {
  constexpr float kGrass = 10.0F;
  constexpr float kCity = 13.0F;
  const auto ground = [](int discipline, int category, int number, std::vector<float> values,
                         int centre) {
    return BytesOf({.discipline = discipline,
                    .category = category,
                    .number = number,
                    .centre = centre,
                    .level = {1, 0},
                    .grid = GridOf({}),
                    .points = 4,
                    .values = std::move(values)});
  };
  const auto land_of = [&](int centre) {
    const auto file =
        DescribeAlone(Write("land", FileOf({.centre = centre}) +
                                        ground(2, 0, 198, {kGrass, kCity, kGrass, kGrass}, centre) +
                                        ground(2, 0, 0, {1.0F, 1.0F, 0.0F, 1.0F}, centre) +
                                        ground(0, 1, 42, {0.0F, 0.0F, 0.0F, 100.0F}, centre)));
    return file->reader->Read(0, std::nullopt, {})->land;
  };
  const volume::LandSurface land = land_of(7);
  const volume::LandSurface expected =
      volume::MakeLandSurface({.scheme = physics::LandUseScheme::kModis,
                               .land_use = {kGrass, kCity, kGrass, kGrass},
                               .water = {0.0F, 0.0F, 1.0F, 0.0F},
                               .snow_share = {0.0F, 0.0F, 0.0F, 1.0F}},
                              {2, 2});
  EXPECT_EQ(land.texels, expected.texels);
  EXPECT_EQ(land.mean_albedo, expected.mean_albedo);
  EXPECT_EQ(land.texels[2].a, 255);
  EXPECT_GT(land.texels[3].r, land.texels[0].r);
  // Numbers of another centre's table mean something else.
  EXPECT_TRUE(land_of(98).Empty());
}

TEST_F(GribStormTest, NamesHeightsThatCannotBeKnown) {
  const auto no_heights = [](Message& message) {
    return message.number != 5 || message.level.type == 1;
  };
  EXPECT_THAT(ErrorWith(no_heights), HasSubstr("neither heights (0/3/5, 0/3/6) nor coefficients"));
  EXPECT_THAT(ErrorWith(no_heights, {.level_type = 150}),
              HasSubstr("add the files with the heights of half levels (HHL, 0/3/6)"));
  EXPECT_THAT(ErrorWith(no_heights, {.level_type = 118}), HasSubstr("neither heights"));
  EXPECT_THAT(ErrorWith([](Message& message) {
                return message.number != 0 || message.category != 3 || message.level.type == 1;
              }),
              HasSubstr("pressure (0/3/0) of hybrid level 1 and the others is missing"));
}

TEST_F(GribStormTest, TheHeightOfTheGroundMustBeThereAndPossible) {
  const auto is_ground = [](const Message& message) { return Is(message, 3, 5, 0, 1); };
  EXPECT_THAT(ErrorWith([&](Message& message) {
                if (is_ground(message)) message.values = {9500.0F};
                return true;
              }),
              HasSubstr("the height of the ground, of record 0 is 9500 m in column (0, 0), which"));
  EXPECT_THAT(ErrorWith([&](Message& message) {
                if (!is_ground(message)) return true;
                message.values = {400.0F, 400.0F, 500.0F};
                message.bitmap = "\xB0";
                return true;
              }),
              HasSubstr("is missing in 1 of 4 columns, the first of which is column (1, 0)"));
}

TEST_F(GribStormTest, ReadsOtherModelLevels) {
  for (const int type : {118, 119}) {
    const auto file = Describe({.level_type = type});
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_TRUE(file->reader->Read(0, std::nullopt, {}).ok());
  }
}

// Returns a layout with the pressure levels 1000, 900, 800 and 700 hPa. The first is below the
// ground, which is at 990 hPa.
Layout Isobaric() {
  Layout layout;
  layout.level_type = 100;
  layout.edit = [](Message& message) {
    if (message.level.type != 100) return true;
    message.level.value = 110'000 - 10'000 * message.level.value;
    if (message.number == 5)
      message.values[0] = message.level.value == 100'000 ? 300.0F : message.values[0];
    return message.category != 3 || message.number != 0;
  };
  return layout;
}

TEST_F(GribStormTest, CutsIsobaricLevelsAtTheGround) {
  const auto file = Describe(Isobaric());
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->assumptions, Contains("Levels below the ground are left out."));
  const auto fields = file->reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(fields->grid.low_corner_m.z, 400.0, 1.0);
  // Heights are 2000, 3000 and 4000 m from 900 hPa up, and the ground is at 400 m.
  const double mass =
      (90'000.0 * 2100 + 80'000.0 * 1000 + 70'000.0 * 1000) / (287.0 * 280.0) * 8 / 16384;
  EXPECT_NEAR(PathAt(*fields, 1, 0), mass, 0.002 * mass);
}

TEST_F(GribStormTest, ComputesAMissingHeight) {
  Layout layout = Isobaric();
  const auto edit = layout.edit;
  layout.edit = [edit](Message& message) {
    return edit(message) && !Is(message, 3, 5, 80'000, 100);
  };
  const auto file = Describe(layout);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->assumptions, Contains(HasSubstr("(hydrostatic): 800 hPa")));
  EXPECT_TRUE(file->reader->Read(0, std::nullopt, {}).ok());
}

// Returns a file in ICON's layout: generalized levels, numbered from 1 at the top, between half
// levels whose heights are known.
std::string Generalized(const std::vector<float>& grid_of_fields,
                        const std::vector<float>& grid_of_heights, bool are_layers = true) {
  Layout layout;
  layout.centre = 78;
  layout.edit = [&](Message& message) {
    if (message.level.type == 1) return false;
    message.level = {150, message.level.value, 0, 150, message.level.value + 1};
    if (!are_layers) message.level.second_type = 255;
    message.coordinates = grid_of_fields;
    if (message.category == 1 && message.number == 0) message.values = {0.05F};
    return message.category != 3 || message.number != 5;
  };
  std::string file = FileOf(layout);
  for (int level = 1; level <= 5; ++level) {
    Message heights;
    heights.category = 3;
    heights.number = 6;
    heights.centre = 78;
    heights.forecast = 0;
    heights.level = {150, level, 0, 101, 0};
    heights.coordinates = grid_of_heights;
    heights.grid = GridOf({});
    heights.points = 4;
    heights.values = {5000.0F - 900.0F * static_cast<float>(level)};
    file += BytesOf(heights);
  }
  return file;
}

TEST_F(GribStormTest, ReadsHeightsOfHalfLevels) {
  const std::vector<float> id = {5.0F, 1.0F, 0.1F, 0.2F, 0.3F, 0.4F};
  const auto file = DescribeAlone(Write("icon", Generalized(id, id)));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->assumptions, Contains(HasSubstr("the whole air")));
  const auto fields = file->reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ(fields->terrain_height_m[0], 500.0F);
  // 900 m thick layers at 900 to 600 hPa and 280 K, with 5 % of vapour and 16 times 2^-14 of water.
  constexpr double kVapour = 0.05 / 0.95;  // per dry air
  constexpr double kShare = 16.0 / 16384.0;
  const double dry = (90'000.0 + 80'000.0 + 70'000.0 + 60'000.0) * 900.0 / (287.0 * 280.0) /
                     (1.0 + 1.608 * kVapour);
  const double rain = dry * (1.0 + kVapour) / (1.0 - kShare) * 8.0 / 16384.0;
  EXPECT_NEAR(PathAt(*fields, 1, 1), rain, 0.002 * rain);
  EXPECT_THAT(file->assumptions, ::testing::Not(Contains(HasSubstr("ends at"))));
  std::vector<float> other = id;
  other[5] = 0.5F;
  EXPECT_THAT(ErrorOf(DescribeAlone(Write("mixed", Generalized(id, other)))),
              HasSubstr("which match the fields' uuidOfVGrid"));
}

// Some programs write layers with one number, as they write half levels.
TEST_F(GribStormTest, LevelsWithOneNumberLieBetweenHalfLevels) {
  const std::vector<float> id = {5.0F, 1.0F, 0.1F, 0.2F, 0.3F, 0.4F};
  const auto layers = DescribeAlone(Write("layers", Generalized(id, id)));
  ASSERT_TRUE(layers.ok()) << layers.status();
  const std::string all = Generalized(id, id, false);
  const auto file = DescribeAlone(Write("single", all));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->assumptions, Contains(HasSubstr("between the half levels k and k + 1")));
  const auto expected = layers->reader->Read(0, std::nullopt, {});
  const auto fields = file->reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(expected.ok() && fields.ok()) << expected.status() << fields.status();
  EXPECT_EQ(fields->terrain_height_m, expected->terrain_height_m);
  for (const std::size_t field : {0U, 1U}) {
    EXPECT_EQ(fields->fields[field].concentration_kg_per_m3,
              expected->fields[field].concentration_kg_per_m3);
  }
  // The message of the last half level is cut off.
  const auto index = grib::ReadIndex(*grib::testing::BytesIn(all));
  ASSERT_TRUE(index.ok()) << index.status();
  const std::uint64_t last = index->fields.back().message_offset;
  EXPECT_THAT(ErrorOf(DescribeAlone(Write("cut", all.substr(0, last)))),
              HasSubstr("the heights of half levels are incomplete: HHL (0/3/6) of half level 5 is "
                        "missing"));
}

// A storm on ICON's triangles. The places of its cells are stored as fields, too.
TEST_F(GribStormTest, ReadsIconsTriangles) {
  const auto mesh = thunderhead::testing::Triangles({60e3, 40e3}, 2500.0);
  const volume::EarthPlace middle{48.0, 11.0};
  const glm::dvec2 core_m(12e3, -7e3);
  constexpr double kWidth_m = 8e3;
  const auto points = static_cast<std::int64_t>(mesh.centres_m.size());
  std::vector<float> latitudes;
  std::vector<float> longitudes;
  std::vector<float> cloud;
  for (const glm::dvec2& at_m : mesh.centres_m) {
    const auto place = thunderhead::testing::FromStereographic(at_m, middle);
    latitudes.push_back(static_cast<float>(place.latitude_deg));
    longitudes.push_back(static_cast<float>(place.longitude_deg));
    const double distance = glm::distance(at_m, core_m) / kWidth_m;
    cloud.push_back(static_cast<float>(1e-3 * std::exp(-distance * distance)));
  }
  Layout layout;
  layout.edit = [&](Message& message) {
    message.grid = grib::testing::TrianglesOf(points);
    message.points = points;
    if (message.category != 1 || message.number != 22) return true;
    message.values = cloud;
    message.step = std::exp2(-22.0F);
    return true;
  };
  const auto place = [&](int number, const std::vector<float>& values, float minimum) {
    Message message;
    message.category = 191;
    message.number = number;
    message.forecast = 0;
    message.level = {1, 0};
    message.grid = grib::testing::TrianglesOf(points);
    message.points = points;
    message.values = values;
    message.minimum = minimum;
    message.step = std::exp2(-14.0F);
    return BytesOf(message);
  };
  const std::string places = place(1, latitudes, 46.0F) + place(2, longitudes, 9.0F);
  const std::string fields_alone = FileOf(layout);
  const auto file = DescribeAlone(Write("icon", fields_alone + places));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_NEAR(file->dx_m, mesh.spacing_m, 0.02 * mesh.spacing_m);
  EXPECT_THAT(file->assumptions, Contains(HasSubstr("values of the nearest cell")));
  const auto fields = file->reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  // Rain is the same everywhere, so it shows how many times as much cloud there is.
  const std::size_t columns = static_cast<std::size_t>(file->cells.x) * file->cells.y;
  double largest = 0.0;
  double sum = 0.0;
  glm::dvec2 centroid(0.0);
  for (std::size_t i = 0; i < columns; ++i) {
    const double path = PathAt(*fields, 0, i);
    if (path > 0.0) largest = std::max(largest, path / PathAt(*fields, 1, i));
    sum += path;
    centroid += path * glm::dvec2(i % file->cells.x, i / file->cells.x);
  }
  // Rain reaches the edge of this small domain, and so its mass is kept less exactly.
  EXPECT_NEAR(largest / (*std::ranges::max_element(cloud) * 16384.0 / 8.0), 1.0, 0.02);
  const auto map =
      volume::MapProjection::Of(file->projection, {*file->latitude_deg, *file->longitude_deg});
  ASSERT_TRUE(map.ok()) << map.status();
  const glm::dvec2 world_m =
      (centroid / sum + 0.5 - 0.5 * glm::dvec2(file->cells)) * glm::dvec2(file->dx_m, file->dy_m);
  const auto found = map->PlaceOf(world_m);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(thunderhead::testing::Distance_m(
                *found, thunderhead::testing::FromStereographic(core_m, middle)),
            0.25 * mesh.spacing_m);
  EXPECT_THAT(ErrorOf(DescribeAlone(Write("alone", fields_alone))),
              HasSubstr("grid 44 (uuidOfHGrid a27b8de6-18c4-11e4-820a-b5b098c6a5c0), whose places "
                        "are missing; add the files"));
  const auto index = grib::ReadIndex(*grib::testing::BytesIn(places));
  ASSERT_TRUE(index.ok()) << index.status();
  const auto parts = GribPartsOf(*index);
  ASSERT_TRUE(parts.ok()) << parts.status();
  ASSERT_EQ(parts->size(), 1U);
  EXPECT_EQ(parts->front().kind, GribPartKind::kInvariant);
}

TEST_F(GribStormTest, StatesThatHeightsReachHigherThanFields) {
  const std::string all = Generalized({}, {});
  std::string lower;
  const auto index = grib::ReadIndex(*grib::testing::BytesIn(all));
  for (std::size_t i = 0; i < index->fields.size(); ++i) {
    const grib::Field& field = index->fields[i];
    if (field.first.value == 1.0 && field.parameter.number != 6) continue;
    const std::uint64_t end =
        i + 1 < index->fields.size() ? index->fields[i + 1].message_offset : all.size();
    lower += all.substr(field.message_offset, end - field.message_offset);
  }
  const auto file = DescribeAlone(Write("lower", lower));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->cells.z, 3);
  EXPECT_THAT(file->assumptions,
              Contains("The storm ends at generalized level 2, because no field is on the levels "
                       "above, whose heights are given."));
}

TEST_F(GribStormTest, OneHybridLevelIsNoPartOfIsobaricLevels) {
  Layout layout = Isobaric();
  const std::string extra = FileOf({.levels = 1, .edit = [](Message& message) {
                                      return message.category == 1 && message.level.type == 105;
                                    }});
  const auto file = DescribeAlone(Write("gfs", extra + FileOf(layout)));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->cells.z, 4);
}

// A file that was cut between two messages may lack the hydrometeors of its last levels.
TEST_F(GribStormTest, StatesIsobaricLevelsWithoutHydrometeors) {
  const auto assumptions_without = [this](const std::vector<int>& levels) {
    Layout layout = Isobaric();
    const auto edit = layout.edit;
    layout.edit = [=](Message& message) {
      return edit(message) && !(message.category == 1 && message.number != 0 &&
                                std::ranges::find(levels, message.level.value) != levels.end());
    };
    return Describe(layout)->assumptions;
  };
  EXPECT_THAT(assumptions_without({70'000, 100'000}),
              Contains("Levels that not all fields have are left out: 700 hPa, 1000 hPa."));
  // Hydrometeors may be on fewer levels than temperature.
  EXPECT_THAT(assumptions_without({80'000}), ::testing::Not(Contains(HasSubstr("left out: "))));
}

TEST_F(GribStormTest, LeavesOutIsobaricLevelsAtTheEnds) {
  Layout layout = Isobaric();
  const auto edit = layout.edit;
  layout.edit = [edit](Message& message) {
    return edit(message) && !Is(message, 1, 24, 70'000, 100);
  };
  const auto file = Describe(layout);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->cells.z, 3);
  EXPECT_THAT(file->assumptions, Contains(HasSubstr("left out: 700 hPa")));
  layout.edit = [edit](Message& message) {
    return edit(message) && !Is(message, 1, 24, 80'000, 100);
  };
  EXPECT_THAT(ErrorOf(Describe(layout)), HasSubstr("RWMR (0/1/24) of 800 hPa is missing"));
}

TEST_F(GribStormTest, NamesDamagedFiles) {
  const std::string whole = FileOf({});
  EXPECT_THAT(ErrorOf(DescribeAlone(Write("cut", whole.substr(0, whole.size() / 2 + 10)))),
              HasSubstr("it was cut short: copy it again"));
  EXPECT_THAT(ErrorOf(DescribeAlone(Write("first", "GRIB\x01\x02\x03\x01" + whole.substr(8)))),
              HasSubstr("GRIB edition 1"));
  EXPECT_THAT(
      ErrorOf(DescribeAlone(Write(
          "precipitation",
          BytesOf(
              {.category = 1, .number = 8, .grid = GridOf({}), .points = 4, .values = {0.0F}})))),
      HasSubstr("has no field that a storm needs"));
}

// The listing of a file names messages beyond its end if the file was cut short.
TEST_F(GribStormTest, NamesAListingOfMore) {
  const std::string whole = FileOf({});
  const auto index = grib::ReadIndex(*grib::testing::BytesIn(whole));
  std::string listing;
  for (std::size_t i = 0; i < index->fields.size(); ++i) {
    listing += absl::StrCat(i + 1, ":", index->fields[i].message_offset,
                            ":d=2024052021:TMP:1 hybrid level:1 hour fcst:\n");
  }
  const std::uint64_t last = index->fields.back().message_offset;
  const auto error = [&](std::uint64_t size) {
    const std::string path = Write("listed", whole.substr(0, size));
    const base::FileDescriptor file = *base::OpenRegularFile(path);
    return std::string(StormFormats::BuiltIn().CheckStart(path, file.Get()).message());
  };
  EXPECT_EQ(error(last), "");
  Write("listed.idx", listing);
  EXPECT_EQ(error(whole.size()), "");
  EXPECT_EQ(error(last + 1), "");
  EXPECT_THAT(error(last), HasSubstr(absl::StrCat("ends at byte ", last)));
  EXPECT_THAT(error(last), HasSubstr(absl::StrCat("listed.idx names a message at byte ", last,
                                                  "; it was cut short: copy it again")));
  // The listing itself may be cut, or be another kind of file.
  Write("listed.idx", listing.substr(0, listing.size() - 1));
  EXPECT_THAT(error(last), HasSubstr("cut short"));
  Write("listed.idx", listing + "999:9999");
  EXPECT_EQ(error(whole.size()), "");
  Write("listed.idx", "no listing: 1:2:3\n:999999:\n");
  EXPECT_EQ(error(last), "");
}

// Returns the message with a member: template 4.1 in place of 4.0, with three more octets.
std::string AsMember(const std::string& message, int member) {
  constexpr std::size_t kTemplate_octets = 34;
  std::size_t at = 16;
  while (message[at + 4] != 4) {
    at += (static_cast<std::size_t>(static_cast<unsigned char>(message[at + 2])) << 8U) +
          static_cast<unsigned char>(message[at + 3]);
  }
  const std::size_t size =
      static_cast<unsigned char>(message[at + 3]) +
      (static_cast<std::size_t>(static_cast<unsigned char>(message[at + 2])) << 8U);
  std::string section = message.substr(at, size);
  section.insert(kTemplate_octets, std::string("\x03") + static_cast<char>(member) + "\x02");
  section.replace(0, 4, grib::testing::Number(static_cast<std::int64_t>(section.size()), 4));
  section[8] = 1;
  std::string whole = message.substr(0, at) + section + message.substr(at + size);
  whole.replace(8, 8, grib::testing::Number(static_cast<std::int64_t>(whole.size()), 8));
  return whole;
}

TEST_F(GribStormTest, NamesParts) {
  const auto parts_of = [](const std::string& bytes) {
    return *GribPartsOf(*grib::ReadIndex(*grib::testing::BytesIn(bytes)));
  };
  const auto part_of = [&](const Message& message) { return parts_of(BytesOf(message)).at(0); };
  Message heights;
  heights.category = 3;
  heights.number = 6;
  heights.forecast = 0;
  heights.level = {150, 3, 0, 101, 0};
  heights.grid = GridOf({});
  heights.points = 4;
  heights.values = {100.0F};
  Message cloud = heights;
  cloud.category = 1;
  cloud.number = 22;
  cloud.forecast = 2;
  cloud.level = {150, 3, 0, 150, 4};
  EXPECT_EQ(part_of(heights).kind, GribPartKind::kInvariant);
  EXPECT_EQ(part_of(cloud).kind, GribPartKind::kFields);
  EXPECT_EQ(part_of(cloud).of, part_of(heights).of);
  EXPECT_EQ(part_of(cloud).times.size(), 1U);
  EXPECT_TRUE(part_of(heights).times.empty());
  Message later = cloud;
  later.hour = 22;
  EXPECT_NE(part_of(later).of, part_of(cloud).of);
  Message member = cloud;
  member.member = 3;
  EXPECT_EQ(part_of(member).of, part_of(cloud).of);
  EXPECT_EQ(part_of(member).member, "mem03");
  const std::vector<GribPart> both = parts_of(BytesOf(member) + BytesOf(heights));
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0].kind, GribPartKind::kInvariant);
  EXPECT_EQ(both[1].kind, GribPartKind::kFields);
}

// ICON's ensembles: a file for each field and level has all members, and the heights have none.
TEST_F(GribStormTest, MembersArePartsOfATime) {
  const std::vector<float> id = {5.0F, 1.0F, 0.1F, 0.2F, 0.3F, 0.4F};
  const std::string bytes = Generalized(id, id);
  const auto index = grib::ReadIndex(*grib::testing::BytesIn(bytes));
  std::map<std::string, std::string> files;
  for (std::size_t i = 0; i < index->fields.size(); ++i) {
    const grib::Field& field = index->fields[i];
    const std::uint64_t end =
        i + 1 < index->fields.size() ? index->fields[i + 1].message_offset : bytes.size();
    const std::string message = bytes.substr(field.message_offset, end - field.message_offset);
    const std::string name =
        absl::StrCat(field.parameter.category, "_", field.parameter.number, "_", field.first.value);
    files[name] += message;
    const bool is_height = field.parameter == grib::Parameter{0, 3, 6};
    if (is_height) continue;
    files[name] = AsMember(message, 1) + AsMember(message, 2);
  }
  for (const auto& [name, content] : files) Write(name, content);
  const std::string run = folder_.Path().filename().string();
  const auto storms = CloudIn(folder_.Path().string(), StormFormats::BuiltIn());
  EXPECT_THAT(storms, ElementsAre(::testing::Pair(run + "-mem01", ::testing::Gt(0.0)),
                                  ::testing::Pair(run + "-mem02", ::testing::Gt(0.0))));
}

TEST(GribAir, LevelsBelowTheGroundAreEmpty) {
  const std::vector<double> pressure = {100'000.0, 90'000.0, 80'000.0};
  const std::vector<float> heights = {100.0F, 1000.0F, 2000.0F};
  const auto cut = [&](const std::vector<float>& surface, const std::vector<float>& ground) {
    std::vector<float> interfaces = InterfacesBetween(heights, ground, 3, 1);
    CutAtGround(pressure, heights, surface, ground, interfaces);
    return interfaces;
  };
  EXPECT_THAT(cut({95'000.0F}, {400.0F}), ElementsAre(400.0F, 400.0F, 1500.0F, 2500.0F));
  EXPECT_THAT(cut({}, {400.0F}), ElementsAre(400.0F, 400.0F, 1500.0F, 2500.0F));
  EXPECT_THAT(cut({95'000.0F}, {700.0F}), ElementsAre(700.0F, 700.0F, 1500.0F, 2500.0F));
  EXPECT_THAT(cut({101'000.0F}, {50.0F}), ElementsAre(50.0F, 550.0F, 1500.0F, 2500.0F));
  // Without the ground's height, only the level below the ground is missing.
  const std::vector<float> unknown = cut({95'000.0F}, {});
  EXPECT_TRUE(std::isnan(unknown[0]));
  EXPECT_EQ(unknown[1], 550.0F);
}

TEST(GribAir, SplitsCloudByTemperature) {
  EXPECT_EQ(IceShare(230.0F), 1.0F);
  EXPECT_EQ(IceShare(275.0F), 0.0F);
  EXPECT_NEAR(IceShare(253.15F), 0.5F, 1e-6F);
}

// Air at 0 C that is saturated has 611 Pa of vapour.
TEST(GribAir, ComputesVapour) {
  std::vector<float> humidity = {100.0F, 50.0F};
  RelativeHumidityToVapour({100'000.0F, 100'000.0F}, {273.15F, 273.15F}, humidity);
  EXPECT_NEAR(humidity[0], 0.622 * 611.2 / (1e5 - 611.2), 1e-5);
  EXPECT_NEAR(humidity[1], 0.622 * 305.6 / (1e5 - 305.6), 1e-5);
  std::vector<float> specific = {0.01F};
  SpecificHumidityToVapour(specific);
  EXPECT_NEAR(specific[0], 0.01 / 0.99, 1e-7);
}

// An isothermal atmosphere of 0 C has a scale height of 7996 m.
TEST(GribAir, HydrostaticHeightsFollowTheScaleHeight) {
  const std::vector<float> coefficients = {0.0F, 20'000.0F, 0.0F, 0.0F, 0.25F, 1.0F};
  const std::vector<float> pressure = HybridPressures(coefficients, 1, {100'000.0F});
  EXPECT_THAT(pressure, ElementsAre(100'000.0F, 45'000.0F));
  const std::vector<float> heights = HydrostaticInterfaces(pressure, {273.15F}, {200.0F});
  EXPECT_EQ(heights[0], 200.0F);
  EXPECT_NEAR(heights[1], 200.0 + 7996.0 * std::log(1.0 / 0.45), 1.0);
  std::vector<float> omega = {-10.0F};
  OmegaToAscent({50'000.0F}, {273.15F}, omega);
  EXPECT_NEAR(omega[0], 10.0 * 7996.0 / 50'000.0, 0.001);
}

}  // namespace
}  // namespace thunderhead::storm_files
