#include "load/statistics.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::load {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::Optional;

constexpr Period kPeriod{.begin_s = 10.0, .end_s = 20.0};

std::vector<double> Ms(const std::vector<Latency>& latencies) {
  std::vector<double> ms;
  for (const Latency& latency : latencies) ms.push_back(latency.ms);
  return ms;
}

auto Near(double ms) { return DoubleNear(ms, 1e-6); }

TEST(Percentile, IsTheLeastValueThatTheShareDoesNotExceed) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  EXPECT_THAT(Percentile(values, 0.5), Optional(50.0));
  EXPECT_THAT(Percentile(values, 0.95), Optional(95.0));
  EXPECT_THAT(Percentile(values, 0.99), Optional(99.0));
  EXPECT_THAT(Percentile(values, 0.0), Optional(1.0));
  EXPECT_THAT(Percentile(values, 1.0), Optional(100.0));
  EXPECT_THAT(Percentile({7.0}, 0.01), Optional(7.0));
  EXPECT_EQ(Percentile({}, 0.5), std::nullopt);
}

TEST(Latencies, AreCountedToTheFirstFrameOfTheRevisionOrANewerOne) {
  const std::vector<Update> updates = {{11.0, 2}, {11.1, 3}, {11.2, 4}};
  // The arrivals include a frame before the update, a frame of the update's revision, and a frame
  // that skips a revision.
  const std::vector<Arrival> arrivals = {{10.9, 1}, {11.03, 2}, {11.05, 2}, {11.3, 4}};
  EXPECT_THAT(Ms(LatenciesOf(updates, arrivals, kPeriod)),
              ElementsAre(Near(30), Near(200), Near(100)));
}

TEST(Latencies, OfUpdatesOutsideThePeriodDoNotCount) {
  const std::vector<Update> updates = {{9.9, 2}, {10.0, 3}, {20.0, 4}};
  const std::vector<Arrival> arrivals = {{10.2, 4}};
  EXPECT_THAT(Ms(LatenciesOf(updates, arrivals, kPeriod)), ElementsAre(Near(200)));
}

TEST(Latencies, CountAnUnseenUpdateByItsAgeIfThatIsWorse) {
  const std::vector<Update> updates = {{11.0, 2}, {15.0, 3}, {19.95, 4}};
  const std::vector<Arrival> arrivals = {{11.1, 2}};
  EXPECT_THAT(Ms(LatenciesOf(updates, arrivals, kPeriod)), ElementsAre(Near(100), Near(5000)));
  // A frame that arrived after the end of the period does not count.
  EXPECT_THAT(Ms(LatenciesOf({{15.0, 3}}, {{20.5, 3}}, kPeriod)), ElementsAre(Near(5000)));
}

TEST(Spreads, AreFromTheFirstViewerWhoShowsAnUpdateToTheLast) {
  const std::vector<Update> updates = {{9.0, 1}, {11.0, 2}, {12.0, 3}, {13.0, 4}, {19.0, 5}};
  // The second viewer skips revision 3, and the third receives nothing after revision 2.
  const std::vector<Arrival> first = {{9.1, 1}, {11.1, 2}, {12.1, 3}, {13.1, 4}};
  const std::vector<Arrival> second = {{9.5, 1}, {11.2, 2}, {13.4, 4}};
  const std::vector<Arrival> third = {{9.9, 1}, {11.15, 2}};
  EXPECT_THAT(SpreadsOf(updates, {&first, &second}, kPeriod),
              ElementsAre(Near(100), Near(1300), Near(300)));
  EXPECT_THAT(SpreadsOf(updates, {&first, &second, &third}, kPeriod),
              ElementsAre(Near(100), Near(7900), Near(6900)));
  EXPECT_THAT(SpreadsOf(updates, {&first}, kPeriod), ElementsAre(0.0, 0.0, 0.0));
  EXPECT_THAT(SpreadsOf(updates, {}, kPeriod), ElementsAre());
}

TEST(Latencies, GrowFromTheFirstThirdToTheLast) {
  const std::vector<Latency> latencies = {{10.5, 10}, {12.0, 20}, {13.0, 30}, {15.0, 999},
                                          {17.0, 70}, {18.0, 80}, {19.0, 90}};
  const Growth growth = GrowthOf(latencies, kPeriod);
  EXPECT_THAT(growth.first_third_ms, Optional(20.0));
  EXPECT_THAT(growth.last_third_ms, Optional(80.0));
  EXPECT_EQ(GrowthOf({}, kPeriod).first_third_ms, std::nullopt);
}

TEST(FramesPerSecond, CountsThoseOfThePeriod) {
  EXPECT_DOUBLE_EQ(FramesPerSecond({{9.9, 1}, {10.0, 1}, {15.0, 2}, {20.0, 3}}, kPeriod), 0.2);
  EXPECT_EQ(FramesPerSecond({{10.0, 1}}, {10.0, 10.0}), 0.0);
}

}  // namespace
}  // namespace thunderhead::load
