// Tests of a session's marks and pointers.
#include "session/board.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::session {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsEmpty;

constexpr std::uint64_t kAna = 1;
constexpr std::uint64_t kBen = 2;

std::uint64_t Draw(Board& board, std::uint64_t person) {
  const auto id = board.Add(person, {{}}, {});
  EXPECT_TRUE(id.ok()) << id.status();
  return id.value_or(0);
}

std::vector<std::uint64_t> IdsOf(const std::vector<Mark>& marks) {
  std::vector<std::uint64_t> ids;
  for (const Mark& mark : marks) ids.push_back(mark.id);
  return ids;
}

TEST(BoardTest, PeopleEraseTheirOwnMarksAndAPresenterAll) {
  Board board;
  const std::uint64_t first = Draw(board, kAna);
  const std::uint64_t second = Draw(board, kBen);
  EXPECT_TRUE(board.HasOfOthers({first, second}, kAna));
  EXPECT_FALSE(board.HasOfOthers({first}, kAna));
  board.Erase({}, kAna);
  EXPECT_THAT(board.marks(), ElementsAre(Field(&Mark::id, second)));
  board.Erase({}, {});
  EXPECT_THAT(board.marks(), IsEmpty());
}

TEST(BoardTest, RestoredMarksKeepTheirNumbersAndNewOnesGetLargerOnes) {
  Board first;
  Draw(first, kAna);
  Draw(first, kAna);
  Board restored(first.marks());
  EXPECT_EQ(restored.marks(), first.marks());
  EXPECT_EQ(Draw(restored, kBen), 3U);
}

TEST(BoardTest, EachPersonHasOnePointer) {
  Board board;
  board.Point(kAna, glm::dvec3(1.0));
  board.Point(kBen, glm::dvec3(2.0));
  board.Point(kAna, glm::dvec3(3.0));
  EXPECT_THAT(board.pointers(), ElementsAre(AllOf(Field(&Pointer::person_id, kAna),
                                                  Field(&Pointer::position_m, glm::dvec3(3.0))),
                                            Field(&Pointer::person_id, kBen)));
  board.Point(kAna, {});
  const std::uint64_t revision = board.pointers_revision();
  board.Point(kAna, {});
  EXPECT_EQ(board.pointers_revision(), revision);
  EXPECT_THAT(board.pointers(), ElementsAre(Field(&Pointer::person_id, kBen)));
}

TEST(BoardTest, ThereIsAMaximumOfMarks) {
  Board board;
  for (std::size_t i = 0; i < Board::kMaxMarks; ++i) ASSERT_TRUE(board.Add(1, {{}}, {}).ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(board.Add(1, {{}}, {}).status()));
  board.Erase({5}, std::nullopt);
  EXPECT_TRUE(board.Add(1, {{}}, {}).ok());
}

TEST(BoardTest, ReturnsTheChangesOfItsMarksOnce) {
  Board board;
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(board.Add(1, {{}}, {}, "key").ok());
  EXPECT_EQ(board.TakeMarksChange().drawn.size(), 3U);
  EXPECT_TRUE(board.TakeMarksChange().drawn.empty());
  board.Erase({2}, std::nullopt);
  board.HandOver("key", 7);
  ASSERT_TRUE(board.Add(7, {{}}, {}).ok());
  board.Erase({4}, std::nullopt);
  const MarksChange change = board.TakeMarksChange();
  EXPECT_THAT(change.erased, ElementsAre(2U, 4U));
  ASSERT_EQ(change.drawn.size(), 2U) << "which are another person's now";
  EXPECT_EQ(change.drawn[0].person_id, 7U);
}

TEST(BoardTest, MarksAreShownWithTheDomainThatTheyWereDrawnOn) {
  Board board;
  board.ShowDomain("Oklahoma");
  ASSERT_TRUE(board.Add(1, {{}}, {}, "key").ok());
  EXPECT_THAT(IdsOf(board.TakeMarksChange().drawn), ElementsAre(1U));
  const std::uint64_t before = board.marks_revision();
  board.ShowDomain("Bavaria");
  EXPECT_GT(board.marks_revision(), before);
  EXPECT_THAT(board.MarksShown(), IsEmpty());
  MarksChange change = board.TakeMarksChange();
  EXPECT_THAT(change.erased, ElementsAre(1U));
  EXPECT_THAT(change.drawn, IsEmpty());
  ASSERT_TRUE(board.Add(1, {{}}, {}, "key").ok());
  // The new owner is told only about the marks that are shown, and can erase only those.
  board.HandOver("key", 7);
  EXPECT_THAT(IdsOf(board.TakeMarksChange().drawn), ElementsAre(2U));
  board.Erase({}, std::nullopt);
  board.Erase({1}, std::nullopt);
  EXPECT_THAT(board.TakeMarksChange().erased, ElementsAre(2U));
  board.ShowDomain("Oklahoma");
  EXPECT_THAT(IdsOf(board.MarksShown()), ElementsAre(1U));
  change = board.TakeMarksChange();
  EXPECT_THAT(IdsOf(change.drawn), ElementsAre(1U));
  EXPECT_EQ(change.drawn[0].person_id, 7U);
  // The domain changes and changes back between two updates. The update must not remove the marks,
  // because a client applies removals last.
  board.ShowDomain("Bavaria");
  board.ShowDomain("Oklahoma");
  EXPECT_THAT(board.TakeMarksChange().erased, IsEmpty());
}

TEST(BoardTest, MarksOfAnUnknownDomainGetTheFirstThatIsShown) {
  Board board({{.id = 3, .person_id = 1, .positions_m = {{}}}});
  EXPECT_THAT(IdsOf(board.MarksShown()), ElementsAre(3U));
  board.ShowDomain("Oklahoma");
  EXPECT_THAT(IdsOf(board.MarksShown()), ElementsAre(3U));
  board.ShowDomain("Bavaria");
  EXPECT_THAT(board.MarksShown(), IsEmpty());
}

TEST(BoardTest, AFullBoardErasesHiddenMarksFirst) {
  Board board;
  board.ShowDomain("Oklahoma");
  for (std::size_t i = 0; i < 2; ++i) ASSERT_TRUE(board.Add(1, {{}}, {}).ok());
  board.ShowDomain("Bavaria");
  for (std::size_t i = 0; i < Board::kMaxMarks; ++i) ASSERT_TRUE(board.Add(1, {{}}, {}).ok());
  EXPECT_EQ(board.marks().size(), Board::kMaxMarks);
  EXPECT_TRUE(absl::IsFailedPrecondition(board.Add(1, {{}}, {}).status()));
}

TEST(BoardTest, MarksWithoutAKeyKeepTheirPerson) {
  Board board;
  ASSERT_TRUE(board.Add(1, {{}}, {}).ok());
  board.HandOver("", 2);
  EXPECT_EQ(board.marks()[0].person_id, 1U);
}

}  // namespace
}  // namespace thunderhead::session
