// Tests of clients that guess tokens, and of clients behind the same address that have a valid one.
#include "access/wrong_tokens.h"

#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"

namespace thunderhead::access {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const WrongTokens::Time kStart{seconds(1000)};

TEST(WrongTokensTest, AfterManyWrongOnesNoOtherIsLookedAtForAWhile) {
  WrongTokens wrong(5.0);
  int looked_at = 0;
  for (int i = 0; i < 1000; ++i) {
    const Credentials guess{absl::StrCat("guess ", i), absl::StrCat("192.0.2.7:", 1000 + i)};
    const absl::Status may = wrong.MayShow(guess, kStart + milliseconds(i));
    if (may.ok()) {
      ++looked_at;
      wrong.WasWrong(guess, kStart + milliseconds(i));
      continue;
    }
    EXPECT_EQ(may.code(), absl::StatusCode::kResourceExhausted);
    EXPECT_EQ(base::DetailsOf(may).reason, "TOO_MANY_WRONG_TOKENS");
    EXPECT_TRUE(base::DetailsOf(may).retry_after.has_value());
  }
  EXPECT_GE(looked_at, 10);
  EXPECT_LE(looked_at, 16) << "of a thousand within a second";
  EXPECT_TRUE(wrong.MayShow({"a guess", "192.0.2.7:1"}, kStart + seconds(10)).ok());
}

TEST(WrongTokensTest, OthersAreNotHeldUp) {
  WrongTokens wrong(5.0);
  const Credentials anna{"anna's", "192.0.2.7:1"};
  wrong.WasRight(anna);
  for (int i = 0; i < 100; ++i) wrong.WasWrong({absl::StrCat(i), "192.0.2.7:1"}, kStart);
  EXPECT_FALSE(wrong.MayShow({"ben's", "192.0.2.7:1"}, kStart).ok());
  EXPECT_TRUE(wrong.MayShow(anna, kStart).ok()) << "behind the same address";
  EXPECT_TRUE(wrong.MayShow({"ben's", "192.0.2.8:1"}, kStart).ok()) << "from elsewhere";
  EXPECT_TRUE(wrong.MayShow({"", "192.0.2.7:1"}, kStart).ok()) << "shows none";
  // Anna's token was revoked, so it now counts as wrong.
  wrong.WasWrong(anna, kStart);
  EXPECT_FALSE(wrong.MayShow(anna, kStart).ok());
}

TEST(WrongTokensTest, WithoutALimitAllAreLookedAt) {
  WrongTokens wrong(0.0);
  for (int i = 0; i < 100; ++i) wrong.WasWrong({absl::StrCat(i), "192.0.2.7:1"}, kStart);
  EXPECT_TRUE(wrong.MayShow({"another", "192.0.2.7:1"}, kStart).ok());
}

}  // namespace
}  // namespace thunderhead::access
