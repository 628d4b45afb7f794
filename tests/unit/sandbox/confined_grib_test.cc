// Tests that a confined reader reads GRIB files as the program itself does, although ecCodes reads
// its definitions from files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "absl/strings/match.h"
#include "base/error_details.h"
#include "sandbox/confined_files.h"
#include "storm_files/storm_format.h"
#include "tests/support/synthetic_cf.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/grib/messages.h"

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

// A batch of files is described by one reader, which needs the libraries of all of them.
TEST(ConfinedGribParts, DoNotHideTheFilesOfTheirBatch) {
  const testing::TemporaryFolder folder;
  const std::string other = folder.File("cloud.nc");
  testing::WriteCf(testing::ExtinctionFile(2, 2, 2, 1000.0, 1000.0, 500.0,
                                           [](auto, auto, auto) { return 1e-3; }),
                   other);
  const std::string grib = (kShared / "hrrr-native/hrrr.t21z.wrfnatf01.grib2").string();
  for (const std::vector<std::string>& paths :
       {std::vector<std::string>{grib, other}, std::vector<std::string>{other, grib}}) {
    const auto described = Files()->DescribeEach(paths);
    ASSERT_EQ(described.size(), 2U);
    EXPECT_TRUE(described[0].ok()) << described[0].status();
    EXPECT_TRUE(described[1].ok()) << described[1].status();
  }
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

// Small files that need far more memory or time than their size. A reader has 1 GiB and a minute.
// Returns a message with the cloud water of one level.
grib::testing::Message CloudWater() {
  grib::testing::Message message;
  message.grid = grib::testing::GridOf({.columns = 4, .rows = 4, .step = 100});
  message.points = 16;
  message.values = {1e-3F};
  message.category = 1;
  message.number = 22;
  return message;
}

class ConfinedGribBombs : public ::testing::Test {
 protected:
  void SetUp() override {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "AddressSanitizer ends the program where others throw std::bad_alloc";
#endif
  }

  // Returns a storm with one value a field, on two levels and `side` x `side` columns.
  static std::string Storm(int side) {
    std::string bytes;
    grib::testing::Message message;
    message.grid = grib::testing::GridOf({.columns = side, .rows = side, .step = 100});
    message.points = std::int64_t{side} * side;
    const auto add = [&](int category, int number, float value) {
      message.category = category;
      message.number = number;
      message.values = {value};
      bytes += grib::testing::BytesOf(message);
    };
    for (int level = 1; level <= 2; ++level) {
      const auto height = static_cast<float>(1000 * level);
      message.level = {105, level};
      add(3, 5, height);
      add(3, 0, 100'000.0F - 10.0F * height);
      add(0, 0, 280.0F);
      add(1, 0, 0.0F);
      add(1, 22, 1e-3F);
    }
    message.level = {1, 0};
    add(3, 5, 400.0F);
    return bytes;
  }

  // Returns a storm of two levels with `times` times. At each time the wind lacks another level.
  static std::string ManyTimes(int times) {
    std::string bytes;
    grib::testing::Message message;
    message.grid = grib::testing::GridOf({.columns = 4, .rows = 4, .step = 100});
    message.points = 16;
    const auto add = [&](int category, int number, float value) {
      message.category = category;
      message.number = number;
      message.values = {value};
      bytes += grib::testing::BytesOf(message);
    };
    for (int time = 0; time < times; ++time) {
      message.forecast = time;
      for (int level = 1; level <= 2; ++level) {
        const auto height = static_cast<float>(1000 * level);
        message.level = {105, level};
        add(3, 5, height);
        add(3, 0, 100'000.0F - 10.0F * height);
        add(0, 0, 280.0F);
        add(1, 22, 1e-3F);
      }
      add(2, 2, 5.0F);
    }
    return bytes;
  }

  std::string Write(const std::string& bytes) {
    const std::string path = folder_.File("storm.grib2");
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
    return path;
  }

  // Returns the first error between describing the file and reading its first time.
  absl::Status Read(const std::string& bytes) {
    const auto file = files_->Describe(Write(bytes));
    if (!file.ok()) return file.status();
    return file->reader->Read(0, std::nullopt, {}).status();
  }

  const testing::TemporaryFolder folder_;
  const std::shared_ptr<ConfinedFiles> files_ = Files();
};

TEST_F(ConfinedGribBombs, FieldsLargerThanTheMemoryAreRefused) {
  ASSERT_TRUE(Read(Storm(4)).ok()) << Read(Storm(4));
  // 196 million points, in 2 kB.
  const std::string bomb = Storm(14'000);
  EXPECT_LT(bomb.size(), 4096U);
  EXPECT_EQ(Read(bomb).code(), absl::StatusCode::kResourceExhausted) << Read(bomb);
  EXPECT_TRUE(Read(Storm(4)).ok());
}

TEST_F(ConfinedGribBombs, AHundredThousandMessagesAreIndexedInTime) {
  grib::testing::Message message = CloudWater();
  std::string bytes = Storm(4);
  for (int i = 0; i < 100'000; ++i) {
    message.level = {105, i + 3};
    bytes += grib::testing::BytesOf(message);
  }
  const absl::Status status = Read(bytes);
  EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << status;
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("hybrid level 3 is missing"));
  EXPECT_TRUE(Read(Storm(4)).ok());
}

// The work for a file is proportional to its size, however many times it has. The 12 000 times took
// several minutes when each was searched in all fields, and then the reader was ended.
TEST_F(ConfinedGribBombs, ThousandsOfTimesAreDescribedInTime) {
  const std::string path = Write(ManyTimes(12'000));
  const auto file = files_->Describe(path);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->times.size(), 12'000U);
  EXPECT_LT(file->assumptions.size(), 100U);
}

// A file with one field of a time is no storm alone, and reading it is an error.
TEST_F(ConfinedGribBombs, APartOfATimeIsNotReadAlone) {
  const absl::Status status = Read(grib::testing::BytesOf(CloudWater()));
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("only a part of a time"));
}

// A gz file may have several members, one after the other. Each of these holds 16 MiB.
TEST_F(ConfinedGribBombs, CompressedFilesAreDecompressedToALimit) {
  const auto packed = [](const std::string& contents) {
    std::string text(compressBound(contents.size()) + 32, '\0');
    z_stream stream{};
    constexpr int kGzip = 16 + MAX_WBITS;
    deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(contents.data()));
    stream.avail_in = static_cast<uInt>(contents.size());
    stream.next_out = reinterpret_cast<Bytef*>(text.data());
    stream.avail_out = static_cast<uInt>(text.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    text.resize(stream.total_out);
    deflateEnd(&stream);
    return text;
  };
  std::string bytes = packed(Storm(4));
  const std::string zeros = packed(std::string(16 << 20, '\0'));
  for (int i = 0; i < 160; ++i) bytes += zeros;
  const absl::Status refused = Read(bytes);
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted) << refused;
  EXPECT_THAT(std::string(refused.message()),
              ::testing::HasSubstr("storm.grib2: describing it needs more memory"));
  EXPECT_TRUE(base::DetailsOf(refused).permanent);
  EXPECT_TRUE(Read(packed(Storm(4))).ok());
}

}  // namespace
}  // namespace thunderhead::sandbox
