// Tests of headers that netCDF-C would copy past the end of a buffer.
#include "netcdf/classic_header.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>

#include <fstream>
#include <sstream>
#include <string>

#include "netcdf/netcdf_file.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::netcdf {
namespace {

using ::testing::HasSubstr;

std::string BigEndian(std::uint64_t number, int bytes) {
  std::string text;
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) {
    text += static_cast<char>(number >> static_cast<unsigned>(shift) & 0xFFU);
  }
  return text;
}

struct Lengths {
  int dimension_name = 1;
  int attribute_name = 1;
  int variable_name = 1;
  int rank = 1;
};

// Returns a netCDF header in the layout of `version`. It has a dimension, an attribute of the file,
// and a variable with an attribute.
std::string HeaderOf(int version, const Lengths& lengths) {
  const int width = version == 5 ? 8 : 4;
  const auto count = [width](std::uint64_t number) { return BigEndian(number, width); };
  const auto tag = [](std::uint64_t number) { return BigEndian(number, 4); };
  const auto name = [&](int length) {
    return count(static_cast<std::uint64_t>(length)) +
           std::string(static_cast<std::size_t>((length + 3) / 4 * 4), 'n');
  };
  const std::string attributes = tag(12) + count(1) + name(lengths.attribute_name) + tag(2) +
                                 count(5) + "value" + std::string(3, '\0');
  std::string header = std::string("CDF") + static_cast<char>(version) + count(0);
  header += tag(10) + count(1) + name(lengths.dimension_name) + count(1);
  header += attributes;
  header += tag(11) + count(1) + name(lengths.variable_name) +
            count(static_cast<std::uint64_t>(lengths.rank));
  for (int i = 0; i < lengths.rank; ++i) header += count(0);
  header += attributes + tag(5) + count(4) + BigEndian(0, version == 1 ? 4 : 8);
  return header;
}

absl::Status Check(const std::string& header) {
  std::istringstream file(header);
  return CheckClassicHeader(file);
}

std::string MessageOf(int version, const Lengths& lengths) {
  return std::string(Check(HeaderOf(version, lengths)).message());
}

class ClassicHeaderTest : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Versions, ClassicHeaderTest, ::testing::Values(1, 2, 5));

TEST_P(ClassicHeaderTest, LengthsUpToNetcdfsOwnAreRead) {
  EXPECT_TRUE(Check(HeaderOf(GetParam(), {})).ok());
  const absl::Status longest =
      Check(HeaderOf(GetParam(), {NC_MAX_NAME, NC_MAX_NAME, NC_MAX_NAME, NC_MAX_VAR_DIMS}));
  EXPECT_TRUE(longest.ok()) << longest;
}

TEST_P(ClassicHeaderTest, LongerOnesAreNamed) {
  const int version = GetParam();
  constexpr int kTooLong = NC_MAX_NAME + 1;
  EXPECT_THAT(MessageOf(version, {.dimension_name = kTooLong}),
              HasSubstr("a name of 257 bytes for a dimension"));
  EXPECT_THAT(MessageOf(version, {.attribute_name = kTooLong}),
              HasSubstr("a name of 257 bytes for an attribute"));
  EXPECT_THAT(MessageOf(version, {.variable_name = kTooLong}),
              HasSubstr("a name of 257 bytes for a variable"));
  EXPECT_THAT(MessageOf(version, {.rank = NC_MAX_VAR_DIMS + 1}),
              HasSubstr("a variable of 1025 dimensions"));
}

TEST_P(ClassicHeaderTest, AHeaderEndsWithItsLastEntry) {
  const std::string header = HeaderOf(GetParam(), {});
  for (std::size_t bytes = 5; bytes < header.size(); ++bytes) {
    EXPECT_EQ(Check(header.substr(0, bytes)).code(), absl::StatusCode::kDataLoss) << bytes;
  }
}

TEST(ClassicHeaderTest, OtherFormatsArePassed) {
  EXPECT_TRUE(Check("").ok());
  EXPECT_TRUE(Check("\211HDF\r\n\032\n").ok());
  EXPECT_TRUE(Check("CDF\003").ok());
}

TEST(ClassicHeaderTest, AFileWithALongNameIsRefusedByItsPath) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("long_name.nc");
  std::ofstream(path, std::ios::binary) << HeaderOf(1, {.dimension_name = 1537});
  const absl::Status refused = NetcdfFile::Open(path).status();
  EXPECT_THAT(std::string(refused.message()), HasSubstr(path + ": its header has a name of 1537"));
}

}  // namespace
}  // namespace thunderhead::netcdf
