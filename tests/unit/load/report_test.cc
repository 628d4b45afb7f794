#include "load/report.h"

#include "gmock/gmock.h"
#include "google/protobuf/struct.pb.h"
#include "google/protobuf/util/json_util.h"
#include "gtest/gtest.h"
#include "load/bounds.h"
#include "load/load.h"
#include "load/pace.h"

namespace thunderhead::load {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

ViewerRecord Record(ViewerKind kind, int frames, double late_s) {
  ViewerRecord record{.kind = kind, .first_frames_ms = {1e3 * late_s}};
  for (int i = 0; i < frames; ++i) {
    const auto revision = static_cast<std::uint64_t>(1 + i * 10 / frames);
    record.frames.push_back({100.0 + static_cast<double>(revision) - 1.0 + late_s, revision});
    record.frame_bytes += 1000;
    ++record.frame_count;
  }
  record.bytes = 2 * record.frame_bytes;
  return record;
}

// A fixture with a recording of ten seconds and one update of the scene per second. Two viewers see
// each update after 100 and 200 ms, and a viewer on a throttled link after 500 ms.
class ReportTest : public ::testing::Test {
 protected:
  ReportTest() {
    recording_.period = {100.0, 110.0};
    for (int i = 0; i < 10; ++i) {
      recording_.updates.push_back({100.0 + i, static_cast<std::uint64_t>(1 + i)});
    }
    recording_.viewers = {&fast_, &slow_, &throttled_, &stalled_, &passing_};
    recording_.server = {{100.0, 5.0, 400.0}, {105.0, 13.0, 420.0}, {110.0, 20.0, 410.0}};
    recording_.own_cpu_s = 3.0;
    recording_.errors = {{"said \"no\"", 2}, {"gone", 1}};
  }

  const ViewerRecord fast_ = Record(ViewerKind::kHealthy, 40, 0.1);
  const ViewerRecord slow_ = Record(ViewerKind::kHealthy, 20, 0.2);
  const ViewerRecord throttled_ = Record(ViewerKind::kThrottled, 10, 0.5);
  const ViewerRecord stalled_{.kind = ViewerKind::kStalled};
  const ViewerRecord passing_{.kind = ViewerKind::kPassing, .first_frames_ms = {20, 30, 40}};
  Recording recording_;
};

TEST_F(ReportTest, CountsHealthyViewersApartFromOthers) {
  const Report report = ReportOf(recording_);
  EXPECT_EQ(report.healthy.viewers, 2);
  EXPECT_DOUBLE_EQ(report.healthy.fps_min, 2.0);
  EXPECT_DOUBLE_EQ(report.healthy.fps_median, 2.0);
  ASSERT_TRUE(report.healthy.latency_ms.has_value());
  EXPECT_NEAR(report.healthy.latency_ms->p50, 100.0, 1e-6);
  EXPECT_NEAR(report.healthy.latency_ms->p99, 200.0, 1e-6);
  ASSERT_TRUE(report.healthy.spread_ms.has_value());
  EXPECT_NEAR(report.healthy.spread_ms->p50, 100.0, 1e-6);
  EXPECT_DOUBLE_EQ(report.healthy.bytes_per_frame, 1000.0);
  EXPECT_NEAR(report.healthy.kbit_per_viewer, 8.0 * 120.0 / 10.0 / 2.0, 1e-9);
  EXPECT_EQ(report.throttled.viewers, 1);
  EXPECT_DOUBLE_EQ(report.throttled.fps_min, 1.0);
  EXPECT_NEAR(report.throttled.latency_ms->p50, 500.0, 1e-6);
  EXPECT_EQ(report.stalled, 1);
  EXPECT_NEAR(*report.healthy_first.median_ms, 100.0, 1e-6);
  EXPECT_NEAR(*report.healthy_first.most_ms, 200.0, 1e-6);
  EXPECT_EQ(report.passing, 1);
  EXPECT_EQ(report.passing_first.count, 3);
  EXPECT_NEAR(*report.passing_first.median_ms, 30.0, 1e-6);
}

TEST_F(ReportTest, TellsOfTheServerAndOfErrors) {
  const Report report = ReportOf(recording_);
  ASSERT_TRUE(report.server.has_value());
  EXPECT_DOUBLE_EQ(report.server->rss_first_mb, 400.0);
  EXPECT_DOUBLE_EQ(report.server->rss_last_mb, 410.0);
  EXPECT_DOUBLE_EQ(report.server->rss_most_mb, 420.0);
  EXPECT_DOUBLE_EQ(report.server->cpu, 1.5);
  EXPECT_DOUBLE_EQ(report.own_cpu, 0.3);
  EXPECT_EQ(report.ErrorCount(), 3);
  EXPECT_THAT(ToText(report), HasSubstr("2 x said \"no\""));
}

TEST_F(ReportTest, KeepsFewSamplesOfALongLoad) {
  recording_.server.clear();
  for (int i = 0; i < 300; ++i) recording_.server.push_back({100.0 + i, 1.0 * i, 100.0 + i});
  const Report report = ReportOf(recording_);
  EXPECT_EQ(report.server->rss_over_time_mb.size(), 20);
  EXPECT_DOUBLE_EQ(report.server->rss_over_time_mb[1].first, 15.0);
}

google::protobuf::Struct Parsed(const std::string& json) {
  google::protobuf::Struct parsed;
  const auto status = google::protobuf::util::JsonStringToMessage(json, &parsed);
  EXPECT_TRUE(status.ok()) << json;
  return parsed;
}

TEST_F(ReportTest, IsWrittenAsJson) {
  const auto json = Parsed(ToJson(ReportOf(recording_))).fields();
  EXPECT_EQ(json.at("viewers").number_value(), 2);
  EXPECT_EQ(json.at("errors").number_value(), 3);
  const auto messages = json.at("error_messages").struct_value().fields();
  EXPECT_EQ(messages.at("said \"no\"").number_value(), 2);
  const auto memory = json.at("server_rss_mb").struct_value().fields();
  EXPECT_EQ(memory.at("most").number_value(), 420);
  EXPECT_EQ(memory.at("over_time").list_value().values_size(), 3);
  EXPECT_EQ(json.at("throttled").struct_value().fields().at("viewers").number_value(), 1);
  EXPECT_EQ(json.at("spread_ms").struct_value().fields().at("p99").number_value(), 100);
  EXPECT_THAT(ToText(ReportOf(recording_)), HasSubstr("first to last    p50 100 ms"));
}

TEST_F(ReportTest, OfThrottledViewersAloneTellsOfThem) {
  recording_.viewers = {&throttled_};
  Report report = ReportOf(recording_);
  report.throttle_kbit_per_s = 2000.0;
  EXPECT_THAT(ToText(report), StartsWith("1 viewers by"));
  EXPECT_THAT(ToText(report), HasSubstr("throttled: 1 that read at most 2000 kbit/s"));
  EXPECT_THAT(ToText(report), HasSubstr("after 500 ms (median)"));
  EXPECT_THAT(ToText(report), Not(HasSubstr("least 0.0")));
  const auto json = Parsed(ToJson(report)).fields();
  EXPECT_EQ(json.at("viewers").number_value(), 1);
  EXPECT_EQ(json.at("fps_min").number_value(), 1);
  EXPECT_GT(json.at("kbit_per_viewer").number_value(), 0);
  EXPECT_TRUE(json.at("latency_ms").struct_value().fields().at("p50").has_number_value());
  EXPECT_THAT(NotKept({.min_fps = 0.5}, report), testing::IsEmpty());
  EXPECT_THAT(NotKept({.min_fps = 5.0}, report), testing::SizeIs(1));
  const auto throttled = json.at("throttled").struct_value().fields();
  EXPECT_EQ(throttled.at("viewers").number_value(), 1);
  EXPECT_EQ(throttled.at("kbit_limit").number_value(), 2000);
  EXPECT_EQ(throttled.at("fps_min").number_value(), 1);
  EXPECT_EQ(throttled.at("first_frame_ms").struct_value().fields().at("most").number_value(), 500);
}

TEST(Throttle, IsForAllViewersOrForSoManyBesides) {
  LoadOptions options;
  options.viewers = 30;
  Throttle(2000.0, std::nullopt, options);
  EXPECT_EQ(options.kbit_per_s, 2000.0);
  EXPECT_EQ(options.viewers, 0);
  EXPECT_EQ(options.throttled, 30);
  options = {};
  options.viewers = 30;
  Throttle(2000.0, 4, options);
  EXPECT_EQ(options.viewers, 30);
  EXPECT_EQ(options.throttled, 4);
}

TEST_F(ReportTest, WritesNullWhereThereIsNoFigure) {
  recording_.server.clear();
  recording_.updates.clear();
  const auto json = Parsed(ToJson(ReportOf(recording_))).fields();
  EXPECT_TRUE(json.at("server_rss_mb").has_null_value());
  EXPECT_TRUE(json.at("server_cpu").has_null_value());
  EXPECT_TRUE(json.at("latency_ms").struct_value().fields().at("p99").has_null_value());
}

TEST(Pace, DelaysEachMessageByItsTimeOnTheWire) {
  Pace pace(1000.0);  // 1000 kbit/s, which is 125 bytes per millisecond
  const Pace::Clock::time_point now{std::chrono::hours(1)};
  EXPECT_EQ(pace.DelayOf(1250, now), milliseconds(10));
  // The next message waits for the first, but a message after a pause does not wait.
  EXPECT_EQ(pace.DelayOf(1250, now + milliseconds(4)), milliseconds(16));
  EXPECT_EQ(pace.DelayOf(125, now + milliseconds(100)), milliseconds(1));
  EXPECT_FALSE(Pace(0.0).IsLimited());
}

// Two healthy viewers get 4 and 2 frames/s and see updates after 100 and 200 ms. The server grows
// by 10 MB.
TEST_F(ReportTest, BoundsAreKeptOrSaidNotToBe) {
  const Report report = ReportOf(recording_);
  EXPECT_THAT(NotKept({}, report), testing::IsEmpty());
  EXPECT_THAT(NotKept({.min_fps = 2.0,
                       .max_p95_ms = 200.5,
                       .max_p99_ms = 201.0,
                       .max_spread_ms = 101.0,
                       .max_growth_mb = 10.0},
                      report),
              testing::IsEmpty());
  EXPECT_THAT(NotKept({.min_fps = 2.1,
                       .max_p95_ms = 150.0,
                       .max_p99_ms = 150.0,
                       .max_spread_ms = 50.0,
                       .max_growth_mb = 9.0},
                      report),
              testing::ElementsAre("least frames/s 2.0, at least 2.1 wanted",
                                   "latency p95 200 ms, at most 150 ms wanted",
                                   "latency p99 200 ms, at most 150 ms wanted",
                                   "first to last viewer p99 100 ms, at most 50 ms wanted",
                                   "growth of the server's memory 10 MB, at most 9 MB wanted"));
}

TEST_F(ReportTest, ABoundOfWhatWasNotMeasuredIsNotKept) {
  recording_.server.clear();
  EXPECT_THAT(NotKept({.max_growth_mb = 100.0}, ReportOf(recording_)),
              testing::ElementsAre(HasSubstr("not measured")));
}

}  // namespace
}  // namespace thunderhead::load
