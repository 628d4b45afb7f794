// Tests that a confined reader reads GRIB files as the program itself does, although ecCodes reads
// its definitions from files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "absl/strings/match.h"
#include "sandbox/confined_files.h"
#include "storm_files/storm_format.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::sandbox {
namespace {

const std::filesystem::path kShared =
    std::filesystem::path(THUNDERHEAD_SOURCE_DIR).parent_path() / "shared/data/grib";

std::shared_ptr<ConfinedFiles> Files() {
  ConfinedOptions options;
  options.limits = {std::uint64_t{1} << 30, std::chrono::minutes(1)};
  options.program = "/proc/self/exe";
  return std::make_shared<ConfinedFiles>(options);
}

void ExpectSame(const storm_files::StormFile& own, const storm_files::StormFile& confined) {
  EXPECT_EQ(confined.about, own.about);
  EXPECT_EQ(confined.cells, own.cells);
  EXPECT_EQ(confined.times, own.times);
  EXPECT_EQ(confined.fields, own.fields);
  EXPECT_EQ(confined.assumptions, own.assumptions);
  const auto expected = own.reader->Read(0, std::nullopt, {});
  const auto fields = confined.reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(expected.ok()) << expected.status();
  ASSERT_TRUE(fields.ok()) << fields.status();
  ASSERT_EQ(fields->fields.size(), expected->fields.size());
  for (std::size_t i = 0; i < fields->fields.size(); ++i) {
    EXPECT_EQ(fields->fields[i].concentration_kg_per_m3,
              expected->fields[i].concentration_kg_per_m3);
  }
  EXPECT_EQ(fields->motion.turbulence, expected->motion.turbulence);
}

class ConfinedGrib : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Sets, ConfinedGrib,
                         ::testing::Values("hrrr-native/hrrr.t21z.wrfnatf01.grib2",
                                           "hrrr-pressure/hrrr.t21z.wrfprsf01.grib2",
                                           "gfs-0p25-like/gfs.t18z.pgrb2.0p25.f003",
                                           "ifs-like/ifs_2024052012_009_ml.grib2"));

TEST_P(ConfinedGrib, IsReadAsInTheProgram) {
  const std::string path = (kShared / GetParam()).string();
  const auto files = Files();
  const auto own = storm_files::StormFormats::BuiltIn().Describe(path);
  const auto confined = files->Describe(path);
  ASSERT_TRUE(own.ok()) << own.status();
  ASSERT_TRUE(confined.ok()) << confined.status();
  ExpectSame(*own, *confined);
}

// A file may hold several runs or members. The reader counts their records one after the other.
TEST(ConfinedGribStorms, ShareAFile) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("both");
  {
    std::ofstream both(path, std::ios::binary);
    for (const char* const name :
         {"hrrr-native/hrrr.t21z.wrfnatf01.grib2", "gfs-0p25-like/gfs.t18z.pgrb2.0p25.f003",
          "hrrr-native/hrrr.t21z.wrfnatf02.grib2"}) {
      both << std::ifstream(kShared / name, std::ios::binary).rdbuf();
    }
  }
  const auto files = Files();
  const auto own = storm_files::StormFormats::BuiltIn().Describe(path);
  const auto confined = files->Describe(path);
  ASSERT_TRUE(own.ok()) << own.status();
  ASSERT_TRUE(confined.ok()) << confined.status();
  ASSERT_EQ(own->others.size(), 1U);
  ASSERT_EQ(confined->others.size(), 1U);
  ExpectSame(*own, *confined);
  ExpectSame(own->others[0], confined->others[0]);
  const std::vector<storm_files::StormFile> storms = StormsOf(*confined);
  ASSERT_EQ(storms.size(), 2U);
  EXPECT_EQ(storms[0].times.size(), 1U);
  EXPECT_EQ(storms[1].times.size(), 2U);
  EXPECT_EQ(storms[1].first_record, 1U);
  ExpectSame(own->others[0], storms[1]);
  EXPECT_TRUE(storms[1].reader->Read(1, std::nullopt, {}).ok());
  EXPECT_EQ(storms[1].reader->Read(2, std::nullopt, {}).status().code(),
            absl::StatusCode::kDataLoss);
}

TEST(ConfinedGribParts, AreReadTogether) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(kShared / "icon-d2-like")) {
    const std::string name = entry.path().filename().string();
    if (absl::StrContains(name, "_001_") || absl::StrContains(name, "_hhl.")) {
      paths.push_back(entry.path().string());
    }
  }
  std::ranges::sort(paths);
  const auto files = Files();
  const auto own = storm_files::StormFormats::BuiltIn().DescribeTogether(paths);
  const auto confined = files->DescribeTogether(paths.front(), paths);
  ASSERT_TRUE(own.ok()) << own.status();
  ASSERT_TRUE(confined.ok()) << confined.status();
  ExpectSame(*own, *confined);
}

}  // namespace
}  // namespace thunderhead::sandbox
