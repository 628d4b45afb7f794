#include "base/digits.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

TEST(Digits, OtherTextsAreNotDigits) {
  for (const std::string_view text : {"0", "7", "007", "99999999999999999999999"}) {
    EXPECT_TRUE(IsDigits(text)) << text;
  }
  for (const std::string_view text : {"", "-1", "+1", " 1", "1 ", "1.0", "1e3", "0x1", "\xb2"}) {
    EXPECT_FALSE(IsDigits(text)) << text;
    EXPECT_EQ(ParseDigits(text), std::nullopt) << text;
  }
  EXPECT_FALSE(IsDigits(std::string_view("1\0", 2)));
}

TEST(Digits, NumbersHaveUpTo64Bits) {
  EXPECT_EQ(ParseDigits("0"), 0U);
  EXPECT_EQ(ParseDigits("0042"), 42U);
  EXPECT_EQ(ParseDigits("18446744073709551615"), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(ParseDigits("18446744073709551616"), std::nullopt);
  // Only the given part of a longer text is read.
  EXPECT_EQ(ParseDigits(std::string_view("1234", 2)), 12U);
}

}  // namespace
}  // namespace thunderhead::base
