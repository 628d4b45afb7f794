// Tests of the choice of the next picture, of which results are dropped to make space for other
// jobs, and of pictures that fail.
#include "jobs/job_board.h"

#include <chrono>
#include <map>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::jobs {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const Time kNow{hours(24 * 365 * 50)};

void Add(JobBoard& board, const std::string& id, const std::string& owner, std::size_t pictures,
         Time now = kNow) {
  NewJob job{owner, "", {}};
  job.pictures.resize(pictures);
  const absl::Status added = board.Add(id, "key of " + id, std::move(job), now);
  ASSERT_TRUE(added.ok()) << added;
  board.SetSaved(id);
}

// Begins and draws the next picture; returns the id of its job.
std::string DrawNext(JobBoard& board, double draw_ms, Time now = kNow, std::uint64_t bytes = 10) {
  const auto picture = board.Begin(now);
  if (!picture.has_value()) return "";
  board.Drawn(*picture, {*picture, "png", "hash", bytes}, draw_ms, draw_ms, now);
  return picture->job_id;
}

TEST(JobBoard, OwnersGetTheSameTimeHoweverManyJobsTheyHave) {
  JobBoard board({});
  for (int i = 0; i < 9; ++i) Add(board, absl::StrCat("a", i), "anna", 100);
  Add(board, "b", "bert", 100);
  std::map<char, int> drawn;
  for (int i = 0; i < 60; ++i) ++drawn[DrawNext(board, 10.0).front()];
  EXPECT_NEAR(drawn['b'], 30, 1);
}

TEST(JobBoard, JobsOfAnOwnerGetTheSameTimeHoweverLongTheirPicturesTake) {
  JobBoard board({});
  Add(board, "long", "anna", 100);
  Add(board, "short", "anna", 100);
  std::map<std::string, double> ms;
  for (int i = 0; i < 66; ++i) {
    const auto picture = *board.Begin(kNow);
    const double draw_ms = picture.job_id == "long" ? 100.0 : 10.0;
    ms[picture.job_id] += draw_ms;
    board.Drawn(picture, {picture, "png", "", 1}, draw_ms, draw_ms, kNow);
  }
  EXPECT_NEAR(ms["short"] / ms["long"], 1.0, 0.25);
}

TEST(JobBoard, OneThatIsNotSavedIsNotBegun) {
  JobBoard board({});
  NewJob job{"anna", "", std::vector<PictureOrder>(1)};
  ASSERT_TRUE(board.Add("a", "key", job, kNow).ok());
  EXPECT_FALSE(board.Begin(kNow).has_value());
  board.SetSaved("a");
  EXPECT_TRUE(board.Begin(kNow).has_value());
}

TEST(JobBoard, APictureThatIsPutBackWaitsAndIsTriedAFewTimes) {
  JobBoard board({});
  Add(board, "a", "anna", 1);
  Time now = kNow;
  for (int attempt = 1; attempt <= JobBoard::kMaxAttempts; ++attempt) {
    const auto picture = board.Begin(now);
    ASSERT_TRUE(picture.has_value());
    EXPECT_TRUE(board.MayBegin(*picture));
    EXPECT_EQ(board.Attempts(*picture), attempt);
    board.PutBack(*picture, true, now + seconds(5));
    EXPECT_FALSE(board.Begin(now + seconds(4)).has_value());
    EXPECT_EQ(board.NextRetry(now), now + seconds(5));
    now += seconds(5);
  }
  EXPECT_FALSE(board.MayBegin(*board.Begin(now)));
}

TEST(JobBoard, WhatTheServerPutsBackDoesNotCount) {
  JobBoard board({});
  Add(board, "a", "anna", 1);
  for (int i = 0; i < 20; ++i) {
    const auto picture = *board.Begin(kNow);
    EXPECT_EQ(board.Attempts(picture), 1);
    board.PutBack(picture, false, kNow);
  }
}

TEST(JobBoard, WhatEndsAfterItsJobWasCancelledIsNotKept) {
  JobBoard board({});
  Add(board, "a", "anna", 3);
  const auto picture = *board.Begin(kNow);
  board.Cancel("a", kNow);
  EXPECT_FALSE(board.Drawn(picture, {picture, "png", "", 9}, 1.0, 1.0, kNow));
  EXPECT_EQ(board.ResultBytes(), 0U);
  EXPECT_EQ(board.NewsOf("a", 0)->job.ended_at, kNow);
  EXPECT_FALSE(board.Begin(kNow).has_value());
}

TEST(JobBoard, NewsAreWhatHasChanged) {
  JobBoard board({});
  Add(board, "a", "anna", 3);
  const auto all = *board.NewsOf("a", 0);
  EXPECT_EQ(all.pictures.size(), 3U);
  EXPECT_THAT(board.NewsOf("a", all.version)->pictures, IsEmpty());
  (void)board.Begin(kNow);
  const auto news = *board.NewsOf("a", all.version);
  ASSERT_EQ(news.pictures.size(), 1U);
  EXPECT_EQ(news.pictures[0].state, PictureState::kDrawing);
}

TEST(JobBoard, TheStoreIsToldOfEachChangeOnce) {
  JobBoard board({});
  Add(board, "a", "anna", 1);
  EXPECT_EQ(DrawNext(board, 1.0), "a");
  const auto changes = board.TakeChanges();
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].ended_at, kNow);
  ASSERT_EQ(changes[0].pictures.size(), 1U);
  EXPECT_EQ(changes[0].pictures[0].record.state, PictureState::kDrawn);
  EXPECT_THAT(board.TakeChanges(), IsEmpty());
  board.GiveBack(changes);
  EXPECT_EQ(board.TakeChanges().size(), 1U);
}

TEST(JobBoard, JobsAreForgottenAfterTheirTime) {
  JobLimits limits;
  limits.keep = hours(2);
  JobBoard board(limits);
  Add(board, "a", "anna", 1);
  Add(board, "b", "anna", 1);
  DrawNext(board, 1.0, kNow);
  EXPECT_EQ(board.NextExpiry(), kNow + hours(2));
  board.Expire(kNow + hours(2) - seconds(1));
  EXPECT_THAT(board.TakeForgotten(), IsEmpty());
  board.Expire(kNow + hours(2));
  EXPECT_THAT(board.TakeForgotten(), ElementsAre("a"));
  EXPECT_EQ(board.ResultBytes(), 0U);
  EXPECT_TRUE(board.NewsOf("b", 0).has_value()) << "it has not ended";
}

TEST(JobBoard, OnlyResultsThatWereFetchedMakeRoomTheOldestFirst) {
  JobLimits limits;
  limits.max_result_bytes = 30;
  JobBoard board(limits);
  Add(board, "a", "anna", 6);
  for (int i = 0; i < 2; ++i) DrawNext(board, 1.0, kNow + seconds(i));
  // Three pictures are in progress at a time.
  const auto third = *board.Begin(kNow);
  const auto fourth = *board.Begin(kNow);
  board.Drawn(third, {third, "png", "", 10}, 1.0, 1.0, kNow + seconds(2));
  board.Drawn(fourth, {fourth, "png", "", 10}, 1.0, 1.0, kNow + seconds(3));
  EXPECT_THAT(board.MakeRoom(), IsEmpty()) << "nobody has fetched any";
  EXPECT_EQ(board.ResultBytes(), 40U);
  board.Fetched({"a", 2}, kNow);
  board.Fetched({"a", 1}, kNow);
  const auto dropped = board.MakeRoom();
  ASSERT_EQ(dropped.size(), 1U);
  EXPECT_EQ(dropped[0].picture.place, 1U);
  EXPECT_EQ(board.ResultBytes(), 30U);
  EXPECT_EQ(board.ResultOf({"a", 1}).status().code(), absl::StatusCode::kNotFound);
  for (const std::size_t kept : {0, 2, 3}) EXPECT_TRUE(board.ResultOf({"a", kept}).ok());
}

TEST(JobBoard, WhoFetchesNothingPausesAndTakesNothingFromOthers) {
  JobLimits limits;
  limits.max_result_bytes = 40;
  limits.max_result_bytes_per_owner = 20;
  JobBoard board(limits);
  Add(board, "a", "anna", 9);
  EXPECT_EQ(DrawNext(board, 1.0), "a");
  EXPECT_FALSE(board.NewsOf("a", 0)->job.paused.has_value());
  EXPECT_EQ(DrawNext(board, 1.0), "a");
  EXPECT_EQ(DrawNext(board, 1.0), "") << "anna's share is used up";
  EXPECT_EQ(board.Paused(), 7U);
  ASSERT_TRUE(board.NewsOf("a", 0)->job.paused.has_value());
  EXPECT_EQ(board.NewsOf("a", 0)->job.paused->reason, "RESULTS_NOT_FETCHED");
  EXPECT_THAT(board.NewsOf("a", 0)->job.paused->message, HasSubstr("--jobs-quota-each"));
  Add(board, "b", "bert", 9);
  EXPECT_EQ(DrawNext(board, 1.0), "b");
  EXPECT_EQ(DrawNext(board, 1.0), "b");
  EXPECT_THAT(board.MakeRoom(), IsEmpty());
  Add(board, "c", "carl", 1);
  EXPECT_EQ(DrawNext(board, 1.0), "");
  EXPECT_THAT(board.All()[2].paused->message, HasSubstr("--jobs-quota)"));
  // Fetching a result frees space for all jobs.
  board.Fetched({"b", 0}, kNow);
  EXPECT_NE(DrawNext(board, 1.0), "");
  EXPECT_EQ(board.MakeRoom().size(), 1U);
  // Forgetting a job frees space too.
  board.Forget("a");
  EXPECT_NE(DrawNext(board, 1.0), "");
}

TEST(JobBoard, WhetherAJobIsPausedIsNews) {
  JobLimits limits;
  limits.max_result_bytes = 20;
  limits.max_result_bytes_per_owner = 10;
  JobBoard board(limits);
  Add(board, "a", "anna", 3);
  EXPECT_EQ(DrawNext(board, 1.0), "a");
  Add(board, "b", "bert", 2);
  EXPECT_THAT(board.TakePauses(), ElementsAre("a"));
  const std::uint64_t version = board.NewsOf("b", 0)->version;
  EXPECT_EQ(DrawNext(board, 1.0), "b");
  EXPECT_THAT(board.TakePauses(), ElementsAre("b"));
  EXPECT_GT(board.NewsOf("b", 0)->version, version);
  EXPECT_THAT(board.TakePauses(), IsEmpty());
  // Anna's job continues, and Bert's job is paused as before.
  const std::uint64_t before = board.NewsOf("a", 0)->version;
  board.Fetched({"a", 0}, kNow);
  EXPECT_THAT(board.TakePauses(), ElementsAre("a"));
  EXPECT_GT(board.NewsOf("a", 0)->version, before);
  EXPECT_FALSE(board.NewsOf("a", before)->job.paused.has_value());
  EXPECT_THAT(board.NewsOf("a", before)->pictures, IsEmpty());
}

TEST(JobBoard, WhetherResultsCanBeWrittenIsNews) {
  JobBoard board({});
  Add(board, "a", "anna", 2);
  Add(board, "b", "bert", 1);
  EXPECT_EQ(DrawNext(board, 1.0), "a");
  EXPECT_EQ(DrawNext(board, 1.0), "b");
  const Problem problem{absl::StatusCode::kUnavailable, "RESULTS_NOT_WRITTEN", "the disk is full"};
  board.SetUnwritable("a", problem);
  board.SetUnwritable("b", problem);
  EXPECT_THAT(board.TakePauses(), ElementsAre("a")) << "the other job has ended";
  EXPECT_EQ(board.NewsOf("a", 0)->job.paused->message, "the disk is full");
  EXPECT_FALSE(board.NewsOf("b", 0)->job.paused.has_value());
  board.SetUnwritable("a", std::nullopt);
  EXPECT_THAT(board.TakePauses(), ElementsAre("a"));
  // A job whose last picture is drawn but not written waits, too.
  ASSERT_TRUE(board.Begin(kNow).has_value());
  board.SetAllUnwritable(problem);
  EXPECT_THAT(board.TakePauses(), ElementsAre("a"));
  EXPECT_THAT(board.TakePauses(), IsEmpty());
  EXPECT_TRUE(board.NewsOf("a", 0)->job.paused.has_value());
  board.SetAllUnwritable(std::nullopt);
  EXPECT_FALSE(board.NewsOf("a", 0)->job.paused.has_value());
}

// Otherwise two owners who fetch nothing would block all others forever.
TEST(JobBoard, WhoNeverFetchesLosesThePausedJobAndOthersGoOn) {
  JobLimits limits;
  limits.max_result_bytes = 40;
  limits.max_result_bytes_per_owner = 20;
  limits.keep = hours(2);
  JobBoard before(limits);
  Add(before, "a", "anna", 3);
  Add(before, "b", "bert", 3);
  for (int i = 0; i < 4; ++i) DrawNext(before, 1.0, kNow + seconds(i));
  Add(before, "c", "carl", 1);
  EXPECT_EQ(DrawNext(before, 1.0), "");
  JobBoard board(limits);
  for (const char* id : {"a", "b", "c"}) board.Restore(before.Record(id), kNow);
  // Bert fetches his results, although slowly.
  board.Fetched({"b", 0}, kNow + hours(1));
  EXPECT_EQ(DrawNext(board, 1.0, kNow + hours(1), 30), "b");
  const Time ends = kNow + seconds(2) + hours(2);
  EXPECT_EQ(board.NextExpiry(), ends);
  EXPECT_THAT(board.Expire(ends - seconds(1)).dropped, IsEmpty());
  const JobBoard::Expired expired = board.Expire(ends);
  EXPECT_EQ(expired.failed, 1U);
  ASSERT_EQ(expired.dropped.size(), 2U);
  EXPECT_EQ(expired.dropped[1].picture, (PicturePlace{"a", 1}));
  const JobNews ended = *board.NewsOf("a", 0);
  EXPECT_EQ(ended.job.ended_at, ends);
  EXPECT_EQ(ended.job.result_bytes, 0U);
  EXPECT_EQ(ended.pictures[0].problem.reason, "RESULTS_NOT_FETCHED");
  EXPECT_EQ(ended.pictures[2].state, PictureState::kFailed);
  // Carl's job has no results to fetch, so it does not expire.
  EXPECT_TRUE(board.Expire(ends + seconds(1)).dropped.empty());
  board.Fetched({"b", 1}, ends);
  EXPECT_EQ(DrawNext(board, 1.0, ends), "c");
}

TEST(JobBoard, ARestoredBoardKnowsWhatWasFetched) {
  JobLimits limits;
  limits.max_result_bytes_per_owner = 20;
  JobBoard before(limits);
  Add(before, "a", "anna", 3);
  DrawNext(before, 1.0);
  DrawNext(before, 1.0);
  before.Fetched({"a", 0}, kNow);
  JobBoard after(limits);
  after.Restore(before.Record("a"), kNow);
  EXPECT_EQ(DrawNext(after, 1.0), "a");
  EXPECT_TRUE(after.NewsOf("a", 0)->job.ended_at.has_value());
}

// Jobs that were cancelled at once cost nothing, but their records must not accumulate without
// limit.
TEST(JobBoard, RecordsOfCancelledJobsAreBounded) {
  JobLimits limits;
  limits.max_kept_pictures = 50;
  limits.max_kept_pictures_per_owner = 30;
  JobBoard board(limits);
  Add(board, "drawn", "anna", 1);
  DrawNext(board, 1.0);
  for (int i = 0; i < 20; ++i) {
    const std::string id = absl::StrCat("a", i);
    Add(board, id, "anna", 10);
    board.Cancel(id, kNow + seconds(i));
  }
  std::size_t pictures = 0;
  for (const auto& job : board.All()) {
    for (const std::size_t count : job.counts) pictures += count;
  }
  EXPECT_EQ(pictures, 21U) << "of her 30";
  EXPECT_TRUE(board.NewsOf("drawn", 0).has_value()) << "its result was not fetched";
  EXPECT_TRUE(board.NewsOf("a19", 0).has_value());
  EXPECT_FALSE(board.NewsOf("a0", 0).has_value());
  Add(board, "b", "bert", 29);
  // Pictures that wait to be drawn are not dropped for others.
  const absl::Status full =
      board.Add("b2", "key", {"bert", "", std::vector<PictureOrder>(2)}, kNow);
  EXPECT_EQ(base::DetailsOf(full).reason, "TOO_MANY_JOB_PICTURES");
  EXPECT_TRUE(base::DetailsOf(full).retry_after.has_value());
}

TEST(JobBoard, WhatCouldNotBeRemovedFromTheStoreIsGivenAgain) {
  JobBoard board({});
  Add(board, "a", "anna", 1);
  board.Forget("a");
  const std::vector<std::string> forgotten = board.TakeForgotten();
  EXPECT_THAT(forgotten, ElementsAre("a"));
  EXPECT_THAT(board.TakeForgotten(), IsEmpty());
  board.GiveBackForgotten(forgotten);
  EXPECT_THAT(board.TakeForgotten(), ElementsAre("a"));
}

TEST(JobBoard, TheOldestThatHasEndedMakesRoomForANewJob) {
  JobLimits limits;
  limits.max_jobs = 2;
  JobBoard board(limits);
  Add(board, "a", "anna", 1);
  DrawNext(board, 1.0);
  Add(board, "b", "bert", 1);
  const auto add = [&board](const std::string& id) {
    return board.Add(id, "key", {"carl", "", std::vector<PictureOrder>(1)}, kNow);
  };
  EXPECT_EQ(base::DetailsOf(add("c")).reason, "TOO_MANY_JOBS") << "nobody has fetched a's picture";
  board.Fetched({"a", 0}, kNow);
  EXPECT_TRUE(add("c").ok());
  EXPECT_THAT(board.TakeForgotten(), ElementsAre("a"));
  const absl::Status full = board.Add("d", "key", {"dora", "", std::vector<PictureOrder>(1)}, kNow);
  EXPECT_EQ(base::DetailsOf(full).reason, "TOO_MANY_JOBS");
  EXPECT_TRUE(base::DetailsOf(full).retry_after.has_value());
}

TEST(JobBoard, AJobThatIsRefusedCostsNobodyAJobAndOneThatIsTakenTheAskersOwnFirst) {
  JobLimits limits;
  limits.max_kept_pictures = 20;
  JobBoard board(limits);
  Add(board, "b", "bert", 5);
  board.Cancel("b", kNow);
  Add(board, "a", "anna", 5);
  board.Cancel("a", kNow + seconds(1));
  Add(board, "waits", "carl", 5);
  const absl::Status full =
      board.Add("c", "key", {"anna", "", std::vector<PictureOrder>(16)}, kNow);
  EXPECT_EQ(base::DetailsOf(full).reason, "TOO_MANY_JOB_PICTURES");
  EXPECT_THAT(board.TakeForgotten(), IsEmpty());
  Add(board, "d", "anna", 10);
  EXPECT_THAT(board.TakeForgotten(), ElementsAre("a")) << "though b's is older";
}

}  // namespace
}  // namespace thunderhead::jobs
