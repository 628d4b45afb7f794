// Tests of the client's plain values that have no counterpart in other clients. The shared cases
// (tests/clients/cases) test the others.
#include <algorithm>

#include "gtest/gtest.h"
#include "thunderhead_client/back_off.h"
#include "thunderhead_client/parameters.h"
#include "thunderhead_client/statistics.h"

namespace thunderhead::client {
namespace {

using std::chrono::milliseconds;
using TimePoint = std::chrono::steady_clock::time_point;

TEST(BackOff, DelaysOfManyClientsAreSpread) {
  double sum_ms = 0.0;
  milliseconds least = BackOff::kLongestBound;
  for (int client = 0; client < 200; ++client) {
    BackOff back_off;
    const milliseconds delay = back_off.Next(milliseconds(500)) - milliseconds(500);
    least = std::min(least, delay);
    sum_ms += static_cast<double>(delay.count());
  }
  // The delays are uniformly distributed below one second, so the standard error of their mean is
  // 20.4 ms. Fewer than one run in a million fails by chance.
  EXPECT_NEAR(sum_ms / 200.0, 500.0, 5.0 * 20.4);
  EXPECT_LT(least, milliseconds(100));
}

TEST(Statistics, TellsRateBytesAndLatency) {
  Statistics statistics;
  TimePoint now{std::chrono::seconds(100)};
  for (std::uint64_t i = 1; i <= 60; ++i) {
    statistics.SceneTaken(i, now);
    now += milliseconds(40);
    statistics.Received(1000, now);
    statistics.Shown(i, 5.0, now);
  }
  const auto figures = statistics.At(now);
  EXPECT_NEAR(figures.frames_per_s, 25.0, 0.6);
  EXPECT_NEAR(figures.bytes_per_s, 25'000.0, 600.0);
  EXPECT_NEAR(figures.latency_ms.value_or(0.0), 40.0, 1e-6);
  EXPECT_NEAR(figures.decode_ms, 5.0, 1e-9);
  // A frame may arrive before the response that names its revision.
  statistics.Shown(90, 5.0, now);
  statistics.SceneTaken(90, now - milliseconds(300));
  EXPECT_EQ(statistics.At(now + std::chrono::seconds(3)).frames_per_s, 0.0);
}

const Parameter* Find(const std::vector<Parameter>& parameters, const std::string& path) {
  for (const Parameter& each : parameters) {
    if (each.path == path) return &each;
  }
  return nullptr;
}

TEST(Parameters, ValuesAreReadSetWithinLimitsAndCleared) {
  v1::Scene scene;
  const auto parameters = ParametersOf(scene);
  const Parameter& turbidity = *Find(parameters, "sky.turbidity");
  EXPECT_FALSE(NumberIn(scene, turbidity).has_value());
  SetNumber(scene, turbidity, 99.0);
  EXPECT_EQ(scene.sky().turbidity(), 10.0F);
  EXPECT_EQ(NumberIn(scene, turbidity), 10.0);
  Clear(scene, turbidity);
  EXPECT_FALSE(scene.sky().has_turbidity());
  const Parameter& clock = *Find(parameters, "sun.clock.date_time");
  SetText(scene, clock, "2013-05-20T20:00:00Z");
  EXPECT_EQ(scene.sun().clock().date_time(), "2013-05-20T20:00:00Z");
  EXPECT_EQ(TextIn(scene, clock), "2013-05-20T20:00:00Z");
}

TEST(Parameters, EachHasTheFirstSentenceOfItsComment) {
  v1::Scene scene;
  EXPECT_EQ(CommentOf("thunderhead.v1.Sky.ground_albedo"),
            "Diffuse reflectance of the ground, on average.");
  for (const Parameter& each : ParametersOf(scene)) {
    EXPECT_FALSE(CommentOf(each.full_name).empty()) << each.full_name;
  }
}

}  // namespace
}  // namespace thunderhead::client
