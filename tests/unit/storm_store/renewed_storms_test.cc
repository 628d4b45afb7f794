#include "storm_store/renewed_storms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace thunderhead::storm_store {
namespace {

using ::testing::ElementsAre;
using ::testing::Eq;
using ::testing::Optional;

CataloguedStorm MemberIn(const std::string& path, const std::string& member) {
  CataloguedStorm storm;
  storm.info.files = {path};
  storm_files::StormFile& file = storm.files.emplace_back();
  file.path = path;
  file.member = member;
  return storm;
}

// All members of an ensemble may be in one file. When it is written anew with another member, each
// member continues itself.
TEST(RenewedStorms, MembersOfOneFileContinueThemselves) {
  const CataloguedStorm first = MemberIn("eps", "mem01");
  const CataloguedStorm second = MemberIn("eps", "mem02");
  const auto match =
      MatchStorms({&first, &second},
                  {MemberIn("eps", "mem00"), MemberIn("eps", "mem01"), MemberIn("eps", "mem02")});
  EXPECT_THAT(match, ElementsAre(Optional(Eq(1U)), Optional(Eq(2U))));
}

// The run of a file gets another member's place only if its own is gone.
TEST(RenewedStorms, FilesCountMoreThanMembers) {
  CataloguedStorm known = MemberIn("a", "mem01");
  known.info.files.push_back("b");
  CataloguedStorm series = MemberIn("a", "");
  series.info.files.push_back("b");
  EXPECT_THAT(MatchStorms({&known}, {MemberIn("a", "mem01"), series}),
              ElementsAre(Optional(Eq(1U))));
}

}  // namespace
}  // namespace thunderhead::storm_store
