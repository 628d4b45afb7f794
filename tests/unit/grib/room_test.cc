// Tests of the room server/grib: index, decompression, packings and grids, with messages that are
// written here.
#include <bzlib.h>
#include <eccodes.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <random>

#include "grib/decompressed.h"
#include "grib/grid.h"
#include "grib/index.h"
#include "grib/packing_check.h"
#include "grib/values.h"
#include "storm_files/even_columns.h"
#include "storm_files/grib_columns.h"
#include "tests/unit/grib/messages.h"

namespace thunderhead::grib {
namespace {

using storm_files::AxisAngles;
using storm_files::MakeEven;
using storm_files::PlacesOf;
using testing::BytesIn;
using testing::BytesOf;
using ::testing::ElementsAre;
using testing::GridOf;
using ::testing::HasSubstr;
using testing::LatLon;
using testing::Message;
using testing::Number;
using ::testing::Pointwise;

Message Small() {
  Message message;
  message.grid = GridOf({});
  message.points = 4;
  message.values = {0.0F, 1.0F, 2.0F, 3.0F};
  return message;
}

std::string ErrorOf(const std::string& bytes) {
  return std::string(ReadIndex(*BytesIn(bytes)).status().message());
}

absl::StatusOr<std::vector<float>> ValuesOf(const std::string& bytes, std::size_t field = 0) {
  const auto file = BytesIn(bytes);
  const auto index = ReadIndex(*file);
  if (!index.ok()) return index.status();
  return DecodeValues(*file, index->fields[field]);
}

TEST(GribIndex, TellsWhatAFieldIs) {
  Message message = Small();
  message.category = 1;
  message.number = 82;
  message.unit = 0;
  message.forecast = 90;
  message.member = 7;
  message.level = {150, 12, 0, 150, 13};
  const auto index = ReadIndex(*BytesIn(BytesOf(message)));
  ASSERT_TRUE(index.ok()) << index.status();
  ASSERT_EQ(index->fields.size(), 1U);
  const Field& field = index->fields[0];
  EXPECT_EQ(NumbersOf(field.parameter), "0/1/82");
  EXPECT_EQ(field.origin.centre, 7);
  EXPECT_EQ(field.process, 83);
  EXPECT_EQ(field.Valid(),
            absl::FromCivil(absl::CivilMinute(2024, 5, 20, 22, 30), absl::UTCTimeZone()));
  EXPECT_EQ(field.member, 7);
  EXPECT_EQ(field.first.type, 150);
  EXPECT_EQ(field.first.value, 12.0);
  EXPECT_EQ(field.second.value, 13.0);
  EXPECT_TRUE(field.is_instant);
}

TEST(GribIndex, ReadsEachUnitOfTime) {
  const std::vector<std::pair<int, absl::Duration>> units = {
      {0, absl::Minutes(1)}, {1, absl::Hours(1)},   {2, absl::Hours(24)},  {10, absl::Hours(3)},
      {11, absl::Hours(6)},  {12, absl::Hours(12)}, {13, absl::Seconds(1)}};
  for (const auto& [unit, length] : units) {
    Message message = Small();
    message.unit = unit;
    message.forecast = 5;
    const auto index = ReadIndex(*BytesIn(BytesOf(message)));
    ASSERT_TRUE(index.ok()) << index.status();
    EXPECT_EQ(index->fields[0].forecast, 5 * length) << unit;
  }
  // A month has no fixed length.
  Message message = Small();
  message.unit = 3;
  EXPECT_FALSE(ReadIndex(*BytesIn(BytesOf(message)))->fields[0].is_instant);
}

// NCEP puts both components of the wind into one message, and later ones may use an earlier bitmap.
TEST(GribIndex, ReadsRepeatedSections) {
  Message u = Small();
  u.category = 2;
  u.number = 2;
  u.values = {5.0F, 6.0F, 7.0F};
  u.bitmap = std::string(1, '\xD0');
  Message v = u;
  v.number = 3;
  v.values = {8.0F, 9.0F, 10.0F};
  const std::string sections = Section1(u) + testing::Section(3, u.grid) + Section4(u) +
                               Section5(u) + Section6(u) + Section7(u) + Section4(v) + Section5(v) +
                               testing::Section(6, Number(254, 1)) + Section7(v);
  const std::string bytes = testing::Whole(0, sections);
  const auto first = ValuesOf(bytes, 0);
  const auto second = ValuesOf(bytes, 1);
  ASSERT_TRUE(first.ok()) << first.status();
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_THAT(*first, Pointwise(::testing::NanSensitiveFloatEq(), {5.0F, 6.0F, NAN, 7.0F}));
  EXPECT_THAT(*second, Pointwise(::testing::NanSensitiveFloatEq(), {8.0F, 9.0F, NAN, 10.0F}));
}

TEST(GribIndex, ReadsAroundBulletinHeaders) {
  const std::string message = BytesOf(Small());
  const std::string file =
      "\001\r\r\n123\r\r\nYTXX KWBC\r\r\n" + message + "\r\r\n\003" + message + "\n";
  const auto index = ReadIndex(*BytesIn(file));
  ASSERT_TRUE(index.ok()) << index.status();
  EXPECT_EQ(index->fields.size(), 2U);
  EXPECT_TRUE(BeginsLikeGrib(file));
}

TEST(GribIndex, ATextAboutGribIsNoGribFile) {
  const std::string text = "# GRIB2 test files\nEach message begins with GRIB and its length.\n";
  EXPECT_FALSE(BeginsLikeGrib(text));
  EXPECT_FALSE(BeginsLikeGrib("GRIB"));
  EXPECT_TRUE(BeginsLikeGrib("GRIB: " + BytesOf(Small())));
}

TEST(GribIndex, NamesDamage) {
  const std::string whole = BytesOf(Small());
  const std::string cut = whole.substr(0, whole.size() - 9);
  EXPECT_THAT(ErrorOf(cut), HasSubstr("it was cut short"));
  EXPECT_THAT(ErrorOf(whole + cut), HasSubstr("within the GRIB message at byte "));
  std::string bad_end = whole;
  bad_end.back() = '8';
  EXPECT_THAT(ErrorOf(bad_end), HasSubstr("does not end with 7777"));
  std::string bad_section = whole;
  bad_section[16 + 21 + 1] = '\x7F';  // length of section 3
  EXPECT_THAT(ErrorOf(bad_section), HasSubstr("section 3 of "));
  std::string first_edition = whole;
  first_edition[7] = 1;
  EXPECT_THAT(ErrorOf(first_edition), HasSubstr("GRIB edition 1"));
  Message no_date = Small();
  no_date.month = 13;
  EXPECT_THAT(ErrorOf(BytesOf(no_date)), HasSubstr("2024-13-20 21:0:0, which does not exist"));
  EXPECT_THAT(ErrorOf("no message at all, but a text"), HasSubstr("has no GRIB message"));
  EXPECT_THAT(ErrorOf(""), HasSubstr("has no GRIB message"));
}

TEST(GribIndex, ReportsEveryCutMessage) {
  const std::string whole = BytesOf(Small());
  for (std::size_t bytes = 4; bytes < whole.size(); ++bytes) {
    EXPECT_EQ(ReadIndex(*BytesIn(whole.substr(0, bytes))).status().code(),
              absl::StatusCode::kDataLoss)
        << bytes;
  }
}

std::string Bz2(const std::string& text) {
  std::string packed(text.size() * 2 + 1000, '\0');
  auto size = static_cast<unsigned>(packed.size());
  EXPECT_EQ(BZ2_bzBuffToBuffCompress(packed.data(), &size, const_cast<char*>(text.data()),
                                     static_cast<unsigned>(text.size()), 9, 0, 0),
            BZ_OK);
  packed.resize(size);
  return packed;
}

std::string Gz(const std::string& text, int level = 9) {
  z_stream stream{};
  constexpr int kGzip = 16;
  EXPECT_EQ(deflateInit2(&stream, level, Z_DEFLATED, kGzip + MAX_WBITS, 8, Z_DEFAULT_STRATEGY),
            Z_OK);
  std::string packed(text.size() * 2 + 1000, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

std::string TextOf(const base::ByteSource& file) {
  std::string text(file.Size_bytes(), '\0');
  EXPECT_TRUE(file.Read(0, std::as_writable_bytes(std::span(text))).ok());
  return text;
}

TEST(GribDecompression, ReadsBz2AndGz) {
  const std::string message = BytesOf(Small());
  for (const std::string& packed : {Bz2(message), Gz(message), Bz2(message) + Bz2(message)}) {
    const auto file = Decompressed(BytesIn(packed));
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_THAT(TextOf(**file), ::testing::StartsWith(message));
    EXPECT_EQ((*file)->Size_bytes() % message.size(), 0U);
    EXPECT_TRUE(BeginsCompressed(packed));
  }
  EXPECT_EQ(TextOf(**Decompressed(BytesIn(message))), message);
}

TEST(GribDecompression, NamesDamage) {
  const std::string message = BytesOf(Small());
  for (const std::string& packed : {Bz2(message), Gz(message)}) {
    for (std::size_t bytes = 4; bytes < packed.size(); ++bytes) {
      const auto file = Decompressed(BytesIn(packed.substr(0, bytes)));
      ASSERT_EQ(file.status().code(), absl::StatusCode::kDataLoss) << bytes << file.status();
    }
    EXPECT_THAT(
        std::string(Decompressed(BytesIn(packed.substr(0, packed.size() / 2))).status().message()),
        HasSubstr("ends early; copy it again"));
  }
  EXPECT_THAT(std::string(Decompressed(BytesIn(Bz2("a text"))).status().message()),
              HasSubstr("is a bz2 file without a GRIB message"));
}

// The contents are kept in blocks of 1 MiB.
TEST(GribDecompression, ReadsAcrossBlocks) {
  std::string text = BytesOf(Small());
  std::mt19937 random(20130520);
  while (text.size() < 2'500'000) text += static_cast<char>(random());
  const auto file = Decompressed(BytesIn(Gz(text)));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(TextOf(**file), text);
  std::string part((1 << 20) + 2, '\0');
  ASSERT_TRUE((*file)->Read((1 << 20) - 1, std::as_writable_bytes(std::span(part))).ok());
  EXPECT_EQ(part, text.substr((1 << 20) - 1, part.size()));
  EXPECT_FALSE((*file)->Read(text.size() - 1, std::as_writable_bytes(std::span(part))).ok());
}

// Contents that grow are not moved to a larger place, which would need memory for both.
TEST(GribDecompression, NeedsLittleMoreMemoryThanTheContents) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer reserves addresses of its own";
#endif
  constexpr std::size_t kContents_bytes = 40 << 20;
  const auto packed = BytesIn(Gz(BytesOf(Small()) + std::string(kContents_bytes, '\0'), 1));
  const auto decompress_within = [&](std::size_t more_bytes) {
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t most = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + more_bytes;
    const rlimit limit{most, most};
    if (setrlimit(RLIMIT_AS, &limit) != 0) _exit(2);
    _exit(Decompressed(packed).ok() ? 0 : 1);
  };
  EXPECT_EXIT(decompress_within(kContents_bytes + (8 << 20)), ::testing::ExitedWithCode(0), "");
}

// A few kilobytes can hold gigabytes.
TEST(GribDecompression, LimitsTheSize) {
  const std::string bomb = BytesOf(Small()) + std::string(76'000'000, '\0');
  for (const std::string& packed : {Bz2(bomb), Gz(bomb)}) {
    const auto file = Decompressed(BytesIn(packed));
    EXPECT_EQ(file.status().code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_THAT(
        std::string(file.status().message()),
        ::testing::MatchesRegex("test.grib2: the (gz|bz2) file of [0-9]+ bytes holds more than "
                                "[0-9]+ bytes, the most for its size; decompress it with "
                                "(gunzip|bunzip2) first, or split it"));
  }
}

TEST(GribDecompression, TheLimitGrowsWithTheFile) {
  constexpr std::uint64_t kMiB = 1 << 20;
  EXPECT_EQ(MaxDecompressed_bytes(0), 64 * kMiB);
  EXPECT_EQ(MaxDecompressed_bytes(kMiB), 164 * kMiB);
  EXPECT_EQ(MaxDecompressed_bytes(21 * kMiB), 2048 * kMiB);
  EXPECT_EQ(MaxDecompressed_bytes(std::uint64_t{1} << 63), 2048 * kMiB);
}

TEST(GribValues, AreRead) {
  EXPECT_THAT(*ValuesOf(BytesOf(Small())), ElementsAre(0.0F, 1.0F, 2.0F, 3.0F));
  Message constant = Small();
  constant.values = {9999.0F};  // the value by which ecCodes means "missing"
  EXPECT_THAT(*ValuesOf(BytesOf(constant)), ElementsAre(9999.0F, 9999.0F, 9999.0F, 9999.0F));
  Message bitmap = Small();
  bitmap.values = {7.0F, 8.0F};
  bitmap.bitmap = std::string(1, '\x60');
  EXPECT_THAT(*ValuesOf(BytesOf(bitmap)),
              Pointwise(::testing::NanSensitiveFloatEq(), {NAN, 7.0F, 8.0F, NAN}));
  Message empty = Small();
  empty.values.clear();
  empty.bitmap = std::string(1, '\0');
  EXPECT_THAT(*ValuesOf(BytesOf(empty)),
              Pointwise(::testing::NanSensitiveFloatEq(), {NAN, NAN, NAN, NAN}));
}

TEST(GribValues, FewBytesMayNotAnnounceManyValues) {
  Message bomb = Small();
  LatLon grid;
  grid.columns = 50'000;
  grid.rows = 50'000;
  bomb.grid = GridOf(grid);
  bomb.points = 2'500'000'000;
  bomb.values = {1.0F};
  EXPECT_EQ(ValuesOf(BytesOf(bomb)).status().code(), absl::StatusCode::kResourceExhausted);
  bomb.values = {1.0F, 2.0F};
  EXPECT_FALSE(ValuesOf(BytesOf(bomb)).ok());
}

std::vector<std::byte> AsBytes(const std::string& text) {
  const auto* const begin = reinterpret_cast<const std::byte*>(text.data());
  return {begin, begin + text.size()};
}

// Packs 4096 values by ecCodes, and returns sections 5 to 7 within a message of ours.
std::string PackedBy(const char* packing, const std::vector<double>& values) {
  codes_handle* const handle = codes_grib_handle_new_from_samples(nullptr, "regular_ll_sfc_grib2");
  EXPECT_NE(handle, nullptr);
  EXPECT_EQ(codes_set_long(handle, "Ni", 64), 0);
  EXPECT_EQ(codes_set_long(handle, "Nj", 64), 0);
  EXPECT_EQ(codes_set_long(handle, "bitsPerValue", 16), 0);
  std::size_t length = std::strlen(packing);
  EXPECT_EQ(codes_set_double_array(handle, "values", values.data(), values.size()), 0);
  EXPECT_EQ(codes_set_string(handle, "packingType", packing, &length), 0) << packing;
  EXPECT_EQ(codes_set_double_array(handle, "values", values.data(), values.size()), 0);
  const void* bytes = nullptr;
  std::size_t size = 0;
  EXPECT_EQ(codes_get_message(handle, &bytes, &size), 0);
  std::string message(static_cast<const char*>(bytes), size);
  codes_handle_delete(handle);
  return message;
}

struct NamedPacking {
  const char* name;  // in ecCodes
  Packing packing;
};

class GribPacking : public ::testing::TestWithParam<NamedPacking> {};
INSTANTIATE_TEST_SUITE_P(Packings, GribPacking,
                         ::testing::Values(NamedPacking{"grid_simple", Packing::kSimple},
                                           NamedPacking{"grid_ieee", Packing::kIeee},
                                           NamedPacking{"grid_jpeg", Packing::kJpeg2000},
                                           NamedPacking{"grid_png", Packing::kPng},
                                           NamedPacking{"grid_ccsds", Packing::kCcsds},
                                           NamedPacking{"grid_second_order",
                                                        Packing::kSecondOrder}),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

TEST_P(GribPacking, IsReadWithinItsStep) {
  ASSERT_TRUE(PrepareBeforeConfinement().ok());
  std::vector<double> values(4096);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = 280.0 + 20.0 * std::sin(0.01 * static_cast<double>(i));
  }
  const std::string message = PackedBy(GetParam().name, values);
  EXPECT_EQ(ReadIndex(*BytesIn(message))->fields[0].packing, static_cast<int>(GetParam().packing));
  const auto read = ValuesOf(message);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->size(), values.size());
  constexpr double kStep = 40.0 / 65535;
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR((*read)[i], values[i], kStep) << i;
}

// Whatever one changed byte does, the process continues, and returns values or one error.
TEST_P(GribPacking, SurvivesDamage) {
  std::vector<double> values(4096);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i % 97);
  const std::string whole = PackedBy(GetParam().name, values);
  const auto index = ReadIndex(*BytesIn(whole));
  ASSERT_TRUE(index.ok()) << index.status();
  const Field& field = index->fields[0];
  std::size_t errors = 0;
  const auto damage = [&](std::size_t at, unsigned mask) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(static_cast<unsigned char>(damaged[at]) ^ mask);
    const auto read = ValuesOf(damaged);
    errors += read.ok() ? 0 : 1;
    EXPECT_EQ(read.value_or(std::vector<float>(values.size())).size(), values.size());
  };
  const std::size_t begin = field.packing_section.offset;
  const std::size_t data = field.data_section.offset;
  for (std::size_t at = begin; at < begin + field.packing_section.size_bytes; ++at) {
    for (const unsigned mask : {1U, 0x80U, 0xFFU}) damage(at, mask);
  }
  for (std::size_t at = data; at < data + 60; ++at) damage(at, 0xFF);
  EXPECT_GT(errors, 10U);
}

// Packs groups of template 5.2 or 5.3: references 10, 20 and 30 of 8 bits, and 3 + 2 + 3 values of
// 2 bits each.
struct Groups {
  int order = 0;  // of spatial differences; 0 for template 5.2
  std::int64_t values = 8;
  std::int64_t groups = 3;
  int widths = 2;
  std::vector<int> lengths = {3, 2, 3};
  std::int64_t last_length = 3;
  int cut_bytes = 0;
};

absl::Status CheckGroups(const Groups& groups) {
  std::string section5 = Number(groups.values, 4) + Number(groups.order > 0 ? 3 : 2, 2) +
                         testing::Float(0.0F) + Number(0, 2) + Number(0, 2) + Number(8, 1) +
                         Number(0, 1) + Number(1, 1) + Number(0, 1) + Number(0, 8) +
                         Number(groups.groups, 4) + Number(groups.widths, 1) + Number(0, 1) +
                         Number(0, 4) + Number(1, 1) + Number(groups.last_length, 4) + Number(8, 1);
  std::string data;
  if (groups.order > 0) {
    section5 += Number(groups.order, 1) + Number(1, 1);
    data += std::string(static_cast<std::size_t>(groups.order) + 1, '\1');
  }
  data += Number(10, 1) + Number(20, 1) + Number(30, 1);
  for (const int length : groups.lengths) data += Number(length, 1);
  data += std::string(2 - static_cast<std::size_t>(groups.cut_bytes), '\x55');
  const auto packing = AsBytes(testing::Section(5, section5));
  const auto packed = AsBytes(testing::Section(7, data));
  return CheckPacked({static_cast<std::uint64_t>(groups.values), packing, {}, packed});
}

TEST(GribGroups, MustAddUp) {
  for (const int order : {0, 1, 2}) {
    const auto message = [&](Groups groups) {
      groups.order = order;
      return std::string(CheckGroups(groups).message());
    };
    EXPECT_EQ(message({}), "") << order;
    EXPECT_THAT(message({.lengths = {3, 7, 3}}), HasSubstr("groups for more values than the 8"));
    EXPECT_THAT(message({.lengths = {3, 1, 3}}), HasSubstr("groups for fewer values than the 8"));
    EXPECT_THAT(message({.last_length = 4}), HasSubstr("groups for more values than the 8"));
    EXPECT_THAT(message({.groups = 9}), HasSubstr("9 groups for 8 values"));
    EXPECT_THAT(message({.groups = 8}), HasSubstr("end before their groups"));
    EXPECT_THAT(message({.widths = 33}), HasSubstr("a group of 33 bits"));
    EXPECT_THAT(message({.widths = 3}), HasSubstr("end before their last group"));
    EXPECT_THAT(message({.cut_bytes = 1}), HasSubstr("end before their last group"));
  }
  EXPECT_THAT(std::string(CheckGroups({.order = 3}).message()), HasSubstr("of order 3"));
}

// ecCodes reads the first values also if there are no groups. Without this check it would read them
// beyond the end of the data.
TEST(GribGroups, FirstValuesMustBeThere) {
  const auto message = [](int order, int octets, const std::string& data) {
    const std::string section5 =
        Number(8, 4) + Number(3, 2) + std::string(36, '\0') + Number(order, 1) + Number(octets, 1);
    const auto packing = AsBytes(testing::Section(5, section5));
    const auto packed = AsBytes(testing::Section(7, data));
    return std::string(CheckPacked({8, packing, {}, packed}).message());
  };
  EXPECT_EQ(message(2, 0, ""), "");
  EXPECT_EQ(message(0, 0, ""), "");
  EXPECT_EQ(message(2, 4, std::string(12, '\1')), "");
  EXPECT_THAT(message(2, 4, std::string(11, '\1')), HasSubstr("end before their groups"));
  EXPECT_THAT(message(2, 4, ""), HasSubstr("end before their groups"));
  EXPECT_THAT(message(3, 0, ""), HasSubstr("differences of order 3"));
}

// Some programs write a meaningless distance of rows if the grid has only one row.
TEST(GribGrid, OneRowWithoutAWidthIsAsWideAsItsColumns) {
  LatLon one;
  one.rows = 1;
  std::string section = GridOf(one);
  constexpr std::size_t kRowDistance = 68 - 6;  // octet, without the section's length and number
  const auto grid_with = [&](const std::string& distance) {
    section.replace(kRowDistance, 4, distance);
    return ReadGrid(AsBytes(testing::Section(3, section)));
  };
  const auto grid = grid_with("\xff\xff\xff\xff");
  ASSERT_TRUE(grid.ok()) << grid.status();
  EXPECT_DOUBLE_EQ(grid->step.y, grid->step.x);
  EXPECT_THAT(grid->assumptions, ElementsAre(HasSubstr("one row without a width")));
  const auto given = grid_with(Number(500'000, 4));
  ASSERT_TRUE(given.ok()) << given.status();
  EXPECT_DOUBLE_EQ(given->step.y, 0.5);
  EXPECT_TRUE(given->assumptions.empty());
}

TEST(GribGrid, PlacesTheMiddleOfLatitudesAndLongitudes) {
  LatLon layout;
  layout.columns = 5;
  layout.rows = 3;
  layout.first_latitude = 50'000'000;
  layout.first_longitude = 359'000'000;
  layout.scanning = 0;
  Message message = Small();
  message.grid = GridOf(layout);
  const auto grid = ReadGrid(AsBytes(testing::Section(3, message.grid)));
  ASSERT_TRUE(grid.ok()) << grid.status();
  const auto even = MakeEven(PlacesOf(*grid));
  ASSERT_TRUE(even.ok()) << even.status();
  EXPECT_NEAR(even->middle.latitude_deg, 49.0, 1e-9);
  EXPECT_NEAR(even->middle.longitude_deg, 1.0, 1e-9);
  EXPECT_NEAR(even->mean_m.y, 6'371'229.0 * std::numbers::pi / 180.0, 0.01);
  EXPECT_NEAR(even->longest_m.x / even->mean_m.y, std::cos(48.0 * std::numbers::pi / 180.0), 1e-4);
}

// Each scanning mode describes the same field, so all give the same order.
TEST(GribGrid, ArrangesEveryScanningMode) {
  constexpr int kColumns = 3;
  constexpr int kRows = 2;
  for (const int mode : {0x00, 0x40, 0x80, 0xC0, 0x20, 0x60, 0xA0, 0xE0, 0x10, 0x50, 0x90, 0x70}) {
    Grid grid;
    grid.columns = kColumns;
    grid.rows = kRows;
    grid.from_east = (mode & 0x80) != 0;
    grid.from_south = (mode & 0x40) != 0;
    grid.columns_first = (mode & 0x20) != 0;
    grid.alternates = (mode & 0x10) != 0;
    // Writes the points in the file's order: the value tells column and row.
    std::vector<float> values;
    const int lines = grid.columns_first ? kColumns : kRows;
    const int along = grid.columns_first ? kRows : kColumns;
    for (int line = 0; line < lines; ++line) {
      for (int step = 0; step < along; ++step) {
        const int place = grid.alternates && line % 2 == 1 ? along - 1 - step : step;
        int x = grid.columns_first ? line : place;
        int y = grid.columns_first ? place : line;
        if (grid.from_east) x = kColumns - 1 - x;
        if (!grid.from_south) y = kRows - 1 - y;
        values.push_back(static_cast<float>(10 * y + x));
      }
    }
    EXPECT_THAT(Arranged(grid, values), ElementsAre(0.0F, 1.0F, 2.0F, 10.0F, 11.0F, 12.0F)) << mode;
  }
}

// The first point of rows from north to south is the north-west one, so the grid lies south of it.
TEST(GribGrid, ReadsLambertGridsFromNorthToSouth) {
  // 101 x 51 points of 2 km, tangent at 45 N 10 E, which is the middle of the grid.
  const auto section = [](double latitude_deg, double longitude_deg, int scanning) {
    const auto micro = [](double degrees) { return static_cast<int>(std::lround(degrees * 1e6)); };
    return AsBytes(testing::Section(
        3, Number(0, 1) + Number(101 * 51, 4) + Number(0, 2) + Number(30, 2) + Number(6, 1) +
               Number(0, 15) + Number(101, 4) + Number(51, 4) + Number(micro(latitude_deg), 4) +
               Number(micro(longitude_deg), 4) + Number(0x08, 1) + Number(45'000'000, 4) +
               Number(10'000'000, 4) + Number(2'000'000, 4) + Number(2'000'000, 4) + Number(0, 1) +
               Number(scanning, 1) + Number(45'000'000, 4) + Number(45'000'000, 4) +
               Number(-90'000'000, 4) + Number(0, 4)));
  };
  const auto centred = ReadGrid(section(45.0, 10.0, 0x40));
  ASSERT_TRUE(centred.ok()) << centred.status();
  // The place of the point 100 km west and 50 km north of the tangent point is the first one.
  const auto map = volume::MapProjection::Open(centred->projection);
  ASSERT_TRUE(map.ok()) << map.status();
  const volume::EarthPlace north_west = *map->PlaceOf({-100'000.0, 50'000.0});
  const auto grid = ReadGrid(section(north_west.latitude_deg, north_west.longitude_deg, 0));
  ASSERT_TRUE(grid.ok()) << grid.status();
  EXPECT_TRUE(grid->wind_along_grid);
  const auto even = MakeEven(PlacesOf(*grid));
  ASSERT_TRUE(even.ok()) << even.status();
  EXPECT_NEAR(even->middle.latitude_deg, 45.0, 1e-5);
  EXPECT_NEAR(even->middle.longitude_deg, 10.0, 1e-5);
  EXPECT_NEAR(even->dx_m, 2000.0, 0.01);
  // North of the tangent point the map is wider than the Earth.
  const auto far = ReadGrid(section(55.0, 10.0, 0x40));
  ASSERT_TRUE(far.ok()) << far.status();
  EXPECT_LT(MakeEven(PlacesOf(*far))->dx_m, 1980.0);
}

TEST(GribGrid, NamesGridsThatAreNotRead) {
  const auto error = [](int number) {
    return std::string(
        ReadGrid(AsBytes(testing::Section(3, Number(0, 1) + Number(4, 4) + Number(0, 2) +
                                                 Number(number, 2) + std::string(90, '\0'))))
            .status()
            .message());
  };
  const std::map<int, std::string> names = {
      {2, "is stretched (template 3.2)"},
      {3, "is stretched and rotated (template 3.3)"},
      {4, "has latitudes or longitudes at uneven distances (template 3.4)"},
      {5, "has latitudes or longitudes at uneven distances (template 3.5)"},
      {12, "is on a transverse Mercator map (template 3.12)"},
      {13, "has a modelling subdomain on a map (template 3.13)"},
      {23, "has a modelling subdomain on a map (template 3.23)"},
      {31, "is on an Albers map (template 3.31)"},
      {33, "has a modelling subdomain on a map (template 3.33)"},
      {41, "is Gaussian with a rotated pole (template 3.41)"},
      {42, "is Gaussian and stretched (template 3.42)"},
      {43, "is Gaussian and stretched (template 3.43)"},
      {50, "is spectral (spherical harmonics, template 3.50)"},
      {51, "is spectral (spherical harmonics, template 3.51)"},
      {52, "is spectral (spherical harmonics, template 3.52)"},
      {53, "is spectral (spherical harmonics, template 3.53)"},
      {61, "is spectral on a map (template 3.61)"},
      {62, "is spectral on a map (template 3.62)"},
      {63, "is spectral on a map (template 3.63)"},
      {90, "is a satellite's view (template 3.90)"},
      {100, "is unstructured (triangles of an icosahedron) (template 3.100)"},
      {110, "is on an azimuthal map of equal distances (template 3.110)"},
      {120, "has azimuths and ranges of a radar (template 3.120)"},
      {140, "is on a Lambert map of equal areas (template 3.140)"},
      {150, "is HEALPix (template 3.150)"},
      {204, "is curvilinear (template 3.204)"},
      {1000, "is a vertical section (template 3.1000)"},
      {1100, "is a section through time (template 3.1100)"},
      {1200, "is a section through time (template 3.1200)"},
      {32768, "is NCEP's rotated Arakawa E grid, whose rows are offset (template 3.32768)"},
      {4711, "is of a kind that is not known (template 3.4711)"}};
  for (const auto& [number, name] : names) {
    EXPECT_THAT(error(number), ::testing::AllOf(HasSubstr(name), HasSubstr("for example with")));
  }
}

TEST(GribGrid, NamesIconsTriangles) {
  const auto section = [](std::int64_t points) {
    return testing::Section(3, testing::TrianglesOf(points));
  };
  const auto grid = ReadGrid(AsBytes(section(20)));
  ASSERT_TRUE(grid.ok()) << grid.status();
  EXPECT_EQ(grid->columns, 20);
  EXPECT_EQ(grid->rows, 1);
  EXPECT_EQ(grid->cells, "grid 44 (uuidOfHGrid a27b8de6-18c4-11e4-820a-b5b098c6a5c0)");
  EXPECT_THAT(Arranged(*grid, {3.0F, 1.0F, 2.0F}), ElementsAre(3.0F, 1.0F, 2.0F));
  EXPECT_EQ(ReadGrid(AsBytes(section(0))).status().code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(ReadGrid(AsBytes(section(4'000'000'000))).status().code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(ReadGrid(AsBytes(section(20).substr(0, 30))).status().code(),
            absl::StatusCode::kDataLoss);
}

// The rotated equator passes through the middle of this rotated grid. A degree of rotated longitude
// is therefore as long there as a degree on the true equator.
TEST(GribGrid, TurnsRotatedGrids) {
  LatLon layout;
  layout.columns = 3;
  layout.rows = 3;
  layout.first_latitude = -1'000'000;
  layout.first_longitude = -1'000'000;
  layout.flags = 0x38;
  std::string grid_text = GridOf(layout);
  grid_text.replace(7, 2, Number(1, 2));
  grid_text += Number(-40'000'000, 4) + Number(10'000'000, 4) + Number(0, 4);
  const auto grid = ReadGrid(AsBytes(testing::Section(3, grid_text)));
  ASSERT_TRUE(grid.ok()) << grid.status();
  const auto even = MakeEven(PlacesOf(*grid));
  ASSERT_TRUE(even.ok()) << even.status();
  EXPECT_NEAR(even->middle.latitude_deg, 50.0, 1e-9);
  EXPECT_NEAR(even->middle.longitude_deg, 10.0, 1e-9);
  EXPECT_NEAR(even->longest_m.x, 111'198.9, 0.2);
  const auto axis_angles = AxisAngles(*grid);
  ASSERT_TRUE(axis_angles.ok()) << axis_angles.status();
  const std::vector<float>& angles = *axis_angles;
  ASSERT_EQ(angles.size(), 9U);
  EXPECT_NEAR(angles[4], 0.0F, 1e-3F);    // in the middle, x points east
  EXPECT_GT(std::abs(angles[3]), 0.01F);  // at the western side, it does not
}

// The numbers are those of RAP's files on hybrid levels.
TEST(GribGrid, ReadsRotatedGridsByTheirMiddle) {
  const auto section = [](int last_latitude, int scanning) {
    return AsBytes(testing::Section(
        3, Number(0, 1) + Number(953 * 834, 4) + Number(0, 2) + Number(32769, 2) + Number(6, 1) +
               Number(0, 15) + Number(953, 4) + Number(834, 4) + Number(0, 4) + Number(-1, 4) +
               Number(-10'590'603, 4) + Number(220'914'415, 4) + Number(0x38, 1) +
               Number(54'000'000, 4) + Number(254'000'000, 4) + Number(121'813, 4) +
               Number(121'813, 4) + Number(scanning, 1) + Number(last_latitude, 4) +
               Number(22'661'247, 4)));
  };
  const auto grid = ReadGrid(section(46'591'976, 0x40));
  ASSERT_TRUE(grid.ok()) << grid.status();
  EXPECT_TRUE(grid->wind_along_grid);
  EXPECT_NEAR(grid->step.x, 0.1218, 1e-4);
  EXPECT_NEAR(grid->south_west.x, -0.5 * 952 * 0.1218, 0.03);
  EXPECT_NEAR(grid->south_west.y, -0.5 * 833 * 0.1218, 0.03);
  const storm_files::ColumnPlaces places = PlacesOf(*grid);
  const auto even = MakeEven(places);
  ASSERT_TRUE(even.ok()) << even.status();
  EXPECT_NEAR(even->middle.latitude_deg, 54.0, 0.03);
  EXPECT_NEAR(even->middle.longitude_deg, -106.0, 0.06);
  // The distance of two columns in the middle is that of two rows everywhere.
  EXPECT_NEAR(even->longest_m.x, 6'371'229.0 * 0.1218 * std::numbers::pi / 180.0, 15.0);
  EXPECT_THAT(std::string(ReadGrid(section(-46'591'976, 0x40)).status().message()),
              HasSubstr("degrees apart, but its first and last point say"));
  EXPECT_THAT(std::string(ReadGrid(section(46'591'976, 0)).status().message()),
              HasSubstr("but its first and last point say -0.12"));
}

}  // namespace
}  // namespace thunderhead::grib
