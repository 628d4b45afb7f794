// Tests that unreadable files give one clear error that names the file and the cause, and never a
// crash or half a storm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "storm_store/storm_store.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::storm_files {
namespace {

using ::testing::HasSubstr;
using testing::SyntheticWrf;
using testing::TemporaryFolder;
using testing::WrfCell;
using testing::WrfFormat;

class BrokenFiles : public ::testing::Test {
 protected:
  // Returns the first error between opening the storm and reading the fields of its first time.
  absl::Status Read() {
    auto store = storm_store::StormStore::Open({path_}, {.read_ahead = 0});
    if (!store.ok()) return store.status();
    return (*store)->Get((*store)->Storms()[0]->id, 0, {}).status();
  }

  absl::Status Read(const SyntheticWrf& file) {
    testing::WriteWrf(file, path_);
    return Read();
  }

  void ExpectError(const absl::Status& status, const std::string& what) {
    ASSERT_FALSE(status.ok()) << what;
    EXPECT_THAT(std::string(status.message()), HasSubstr(path_));
    EXPECT_THAT(std::string(status.message()), HasSubstr(what));
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.File("wrfout_d01");
};

SyntheticWrf Storm() {
  SyntheticWrf file;
  file.mixing_ratios["QCLOUD"] = [](const WrfCell&) { return 1e-3; };
  file.mixing_ratios["QRAIN"] = [](const WrfCell&) { return 1e-4; };
  return file;
}

TEST_F(BrokenFiles, ASoundFileIsRead) { EXPECT_TRUE(Read(Storm()).ok()) << Read(Storm()); }

TEST_F(BrokenFiles, WithoutAVariableThatIsNeeded) {
  for (const char* name : {"PH", "PHB", "P", "PB", "T", "Times"}) {
    SyntheticWrf file = Storm();
    file.omitted = {name};
    ExpectError(Read(file), name);
  }
}

// The places of the columns give the distances too, so a file without either is refused.
TEST_F(BrokenFiles, WithoutGridSpacing) {
  for (const char* name : {"DX", "DY"}) {
    SyntheticWrf file = Storm();
    file.omitted = {name, "XLAT"};
    ExpectError(Read(file), name);
  }
  SyntheticWrf file = Storm();
  file.dx_m = 0.0;
  ExpectError(Read(file), "DX");
}

TEST_F(BrokenFiles, WithoutAnyHydrometeor) { ExpectError(Read(SyntheticWrf{}), "QCLOUD, QRAIN"); }

TEST_F(BrokenFiles, WithWrongUnits) {
  const std::pair<const char*, const char*> wrong[] = {
      {"QCLOUD", "g kg-1"}, {"QVAPOR", "g/kg"}, {"PB", "hPa"}, {"T", "degC"}, {"PH", "m"}};
  for (const auto& [name, units] : wrong) {
    SyntheticWrf file = Storm();
    file.units[name] = units;
    const absl::Status status = Read(file);
    ExpectError(status, name);
    ExpectError(status, std::string("'") + units + "'");
  }
}

TEST_F(BrokenFiles, WithUnitsThatNobodyKnows) {
  for (const char* name : {"QCLOUD", "QVAPOR", "P", "PB", "T", "PH", "PHB", "HGT"}) {
    for (const std::string units : {"furlongs", "kg kg-2", "Mg kg-1", "10 Pa"}) {
      SyntheticWrf file = Storm();
      file.units[name] = units;
      ExpectError(Read(file), std::string(name) + " has units '" + units + "'");
    }
  }
}

TEST_F(BrokenFiles, OtherSpellingsOfTheRightUnitsAreRead) {
  for (const char* units : {"kg/kg", "kg kg^-1", "kg kg**-1", "1", "", "kg.kg-1"}) {
    SyntheticWrf file = Storm();
    file.units["QCLOUD"] = units;
    EXPECT_TRUE(Read(file).ok()) << units;
  }
}

TEST_F(BrokenFiles, WithGramsPerKilogramThatDoNotSaySo) {
  SyntheticWrf file = Storm();
  file.units["QCLOUD"] = "";
  file.mixing_ratios["QCLOUD"] = [](const WrfCell&) { return 1.5; };
  ExpectError(Read(file), "g/kg");
}

TEST_F(BrokenFiles, WithWrongDimensions) {
  for (const char* name : {"QRAIN", "PH", "T"}) {
    SyntheticWrf file = Storm();
    file.one_level_short = {name};
    ExpectError(Read(file), name);
  }
}

TEST_F(BrokenFiles, StillGrowing) {
  SyntheticWrf without_times = Storm();
  without_times.times.clear();
  ExpectError(Read(without_times), "holds no times");

  SyntheticWrf with_a_blank_time = Storm();
  with_a_blank_time.times = {"2013-05-20_20:00:00", "2013-05-20_21:00:00"};
  with_a_blank_time.times_left_blank = 1;
  ExpectError(Read(with_a_blank_time), "Times of record 1");

  for (const char* name : {"QRAIN", "T", "PHB"}) {
    SyntheticWrf unwritten = Storm();
    unwritten.unwritten = {name};
    const absl::Status status = Read(unwritten);
    ExpectError(status, name);
    ExpectError(status, "holds nothing but fill values");
  }
}

TEST_F(BrokenFiles, WithATimeThatIsNone) {
  for (const std::string time :
       {"2013-02-30_20:00:00", "2013-13-20_20:00:00", "2013-05-20_99:99:99", "2013-05-20_24:00:00",
        "2013-05-20_20:00:60", "2013-05-20_20:00:0x", "2013-05-20_20:00   ", "2013-05-20         ",
        "2013-+5-20_20:00:00", "-013-05-20_20:00:00"}) {
    SyntheticWrf file = Storm();
    file.times = {time};
    ExpectError(Read(file), "Times of record 0 is '" + time + "'");
  }
}

TEST_F(BrokenFiles, WithAStartThatIsNoTime) {
  for (const std::string start : {"2013-13-20_12:00:00", "2013-05-20_99:99:99", "2013-05-20",
                                  "soon", "2013-05-20_12:00:00 +9999"}) {
    SyntheticWrf file = Storm();
    file.simulation_start = start;
    ExpectError(Read(file), "the attribute SIMULATION_START_DATE is '" + start + "'");
  }
}

TEST_F(BrokenFiles, WhoseMinutesCountFromNoTime) {
  SyntheticWrf file = Storm();
  file.omitted = {"Times"};
  file.minutes = {480.0};
  for (const std::string units :
       {"minutes since 2013-13-20 12:00:00", "months since 2013-05-20", "fortnights", "K"}) {
    file.units["XTIME"] = units;
    ExpectError(Read(file), "XTIME has units '" + units + "'");
  }
  file.units.clear();
  file.simulation_start = "2013-05-20_99:99:99";
  ExpectError(Read(file), "SIMULATION_START_DATE");
  file.omitted.insert("SIMULATION_START_DATE");
  ExpectError(Read(file), "no variable Times");
}

TEST_F(BrokenFiles, WithoutAnyAir) {
  SyntheticWrf file = Storm();
  file.pressure_Pa = -5.0;
  ExpectError(Read(file), "no usable air density");
}

TEST_F(BrokenFiles, WithoutHeights) {
  SyntheticWrf file = Storm();
  file.interface_height_m = [](const WrfCell&) { return 100.0; };
  ExpectError(Read(file), "PH + PHB");
}

TEST_F(BrokenFiles, CutShort) {
  for (const WrfFormat format :
       {WrfFormat::kNetcdf4, WrfFormat::kClassic, WrfFormat::kOffset64, WrfFormat::kCdf5}) {
    SyntheticWrf file = Storm();
    file.format = format;
    testing::WriteWrf(file, path_);
    const auto whole = std::filesystem::file_size(path_);
    for (const std::uintmax_t kept : {whole - 4, whole - 100, whole * 9 / 10, whole / 2, whole / 10,
                                      std::uintmax_t{40}, std::uintmax_t{4}, std::uintmax_t{0}}) {
      testing::WriteWrf(file, path_);
      std::filesystem::resize_file(path_, kept);
      ExpectError(Read(), "");
    }
  }
}

TEST_F(BrokenFiles, CutShortAfterItWasOpened) {
  testing::WriteWrf(Storm(), path_);
  const auto store = storm_store::StormStore::Open({path_}, {.read_ahead = 0});
  ASSERT_TRUE(store.ok()) << store.status();
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) / 2);
  ExpectError((*store)->Get("wrfout_d01", 0, {}).status(), "cut short");
  EXPECT_EQ((*store)->CachedBytes(), 0U);
  // Errors are not cached: the repaired file is read.
  testing::WriteWrf(Storm(), path_);
  EXPECT_TRUE((*store)->Get("wrfout_d01", 0, {}).ok());
}

TEST_F(BrokenFiles, ReplacedByAFileOfAnotherSize) {
  testing::WriteWrf(Storm(), path_);
  const auto store = storm_store::StormStore::Open({path_}, {.read_ahead = 0});
  ASSERT_TRUE(store.ok()) << store.status();
  SyntheticWrf other = Storm();
  other.nx = 7;
  testing::WriteWrf(other, path_);
  ExpectError((*store)->Get("wrfout_d01", 0, {}).status(), "replaced");
}

TEST_F(BrokenFiles, OfAnotherKind) {
  std::ofstream(path_) << "These are notes on a storm, and not the storm.";
  ExpectError(Read(), "is not a netCDF file");
}

TEST_F(BrokenFiles, ThatAreNotThere) {
  const absl::Status status = Read();
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  ExpectError(status, "no such file");
}

TEST_F(BrokenFiles, ThatAreEmptyFolders) {
  std::filesystem::create_directory(path_);
  ExpectError(Read(), "holds no storm");
}

TEST_F(BrokenFiles, InAFolderWithNothingElse) {
  std::filesystem::create_directory(path_);
  std::ofstream(path_ + "/notes.txt") << "nothing";
  ExpectError(Read(), "is not a netCDF file");
}

TEST(NoFiles, AreAnError) { EXPECT_FALSE(storm_store::StormStore::Open({}, {}).ok()); }

}  // namespace
}  // namespace thunderhead::storm_files
