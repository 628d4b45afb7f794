// Tests of the client's plain values: camera motions, projection, back-off, playback, statistics,
// and the list of all parameters.
#include <cmath>
#include <numbers>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "thunderhead_client/back_off.h"
#include "thunderhead_client/parameters.h"
#include "thunderhead_client/playback.h"
#include "thunderhead_client/pose.h"
#include "thunderhead_client/projection.h"
#include "thunderhead_client/session_state.h"
#include "thunderhead_client/statistics.h"

namespace thunderhead::client {
namespace {

using std::chrono::milliseconds;
using TimePoint = std::chrono::steady_clock::time_point;

OrbitPose AnOrbit() { return {{0.0, 0.0, 5000.0}, 200.0, 10.0, 50'000.0, 35.0}; }

TEST(Pose, ADragAcrossTheHeightTurnsHalfAround) {
  const Pose turned = Drag(AnOrbit(), 720.0, 0.0, {1280.0, 720.0});
  EXPECT_NEAR(std::get<OrbitPose>(turned).azimuth_deg, 20.0, 1e-9);
  // The elevation stops at the limit.
  const Pose up = Drag(AnOrbit(), 0.0, 720.0, {1280.0, 720.0});
  EXPECT_NEAR(std::get<OrbitPose>(up).elevation_deg, 89.9, 1e-9);
}

TEST(Pose, APannedPointFollowsThePointer) {
  // Seen from the south, right is east. The target therefore moves west.
  OrbitPose south = AnOrbit();
  south.azimuth_deg = 180.0;
  const auto panned = std::get<OrbitPose>(Pan(south, 100.0, 0.0, {1280.0, 720.0}));
  const double metres_per_px = 2.0 * 50'000.0 * std::tan(17.5 * std::numbers::pi / 180.0) / 720.0;
  EXPECT_NEAR(panned.target_m[0], -100.0 * metres_per_px, 1e-6);
  EXPECT_NEAR(panned.target_m[1], 0.0, 1e-6);
}

TEST(Pose, CamerasComeBackAsTheyWereAndOpenOnesHaveNoPose) {
  const auto pose = PoseOf(CameraOf(SpotterPose{{1000.0, -2000.0}, 1.7, 30.0, 5.0, 24.0}));
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR(std::get<SpotterPose>(*pose).place_m[1], -2000.0, 1e-3);
  EXPECT_FALSE(PoseOf(HomeCamera(v1::Camera::kSpotter)).has_value());
  EXPECT_TRUE(HomeCamera(v1::Camera::kTopDown).has_top_down());
}

v1::View AView() {
  v1::View view;
  view.mutable_eye()->set_z_m(1000.0F);
  view.mutable_forward()->set_y(1.0F);
  view.mutable_right()->set_x(0.8F);
  view.mutable_up()->set_z(0.45F);
  return view;
}

TEST(Projection, APointOnAPixelsRayIsAtThatPixel) {
  const v1::Ray ray = RayAt(AView(), {0.5, -0.25});
  v1::Position position;
  position.set_x_m(static_cast<float>(ray.origin().x_m()) + 7000.0F * ray.direction().x());
  position.set_y_m(static_cast<float>(ray.origin().y_m()) + 7000.0F * ray.direction().y());
  position.set_z_m(static_cast<float>(ray.origin().z_m()) + 7000.0F * ray.direction().z());
  const auto point = Project(AView(), position);
  ASSERT_TRUE(point.has_value());
  EXPECT_NEAR(point->x, 0.5, 1e-5);
  EXPECT_NEAR(point->y, -0.25, 1e-5);
  position.set_y_m(-10.0F);
  EXPECT_FALSE(Project(AView(), position).has_value());
}

v1::Mark AMark(const std::vector<std::array<float, 3>>& corners_m) {
  v1::Mark mark;
  for (const auto& [x, y, z] : corners_m) {
    v1::Position& position = *mark.add_positions();
    position.set_x_m(x);
    position.set_y_m(y);
    position.set_z_m(z);
  }
  return mark;
}

TEST(Projection, OfALineIsCutOffBehindTheEye) {
  // The line begins behind the camera, comes to the front, goes behind the camera, and comes to the
  // front again.
  const v1::Mark mark = AMark({{0.0F, -9.0F, 1000.0F},
                               {8.0F, 11.0F, 1000.0F},
                               {8.0F, 21.0F, 1000.0F},
                               {8.0F, -9.0F, 1000.0F},
                               {0.0F, -9.0F, 1000.0F},
                               {0.0F, 11.0F, 1000.0F}});
  const auto parts = ProjectLine(AView(), mark.positions());
  ASSERT_EQ(parts.size(), 2U);
  ASSERT_EQ(parts[0].size(), 4U);
  // The line is cut one metre in front of the eye, where it leads to a corner that is 8 m to the
  // right.
  EXPECT_NEAR(parts[0][0].x, 4.0 / 0.8, 1e-6);
  EXPECT_NEAR(parts[0][1].x, 8.0 / 0.8 / 11.0, 1e-6);
  EXPECT_NEAR(parts[0][3].x, 8.0 / 0.8, 1e-6);
  EXPECT_EQ(parts[1].size(), 2U);
  EXPECT_TRUE(ProjectLine(v1::View(), mark.positions()).empty());
  v1::View above = AView();
  above.set_parallel(true);
  const auto whole = ProjectLine(above, mark.positions());
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_EQ(whole[0].size(), 6U);
  EXPECT_NEAR(whole[0][1].x, 8.0 / 0.8, 1e-6);
}

TEST(BackOff, DelaysGrowAreSpreadAndKeepWhatTheServerAsks) {
  double sum_ms = 0.0;
  milliseconds least{1 << 20};
  for (unsigned seed = 0; seed < 200; ++seed) {
    BackOff back_off(seed);
    for (int i = 0; i < 3; ++i) EXPECT_LE(back_off.Next(), BackOff::kFirstBound * (1 << i));
    const milliseconds delay = back_off.Next(milliseconds(500));
    EXPECT_GE(delay, milliseconds(500));
    EXPECT_LE(delay, milliseconds(500) + BackOff::kLongestBound);
    least = std::min(least, delay);
    sum_ms += static_cast<double>(delay.count());
  }
  // The delays are uniformly distributed below the bound. The standard error of the mean of 200
  // delays is 163 ms, and the mean may be off by four standard errors.
  EXPECT_NEAR(sum_ms / 200.0, 4500.0, 4.0 * 163.0);
  EXPECT_LT(least, milliseconds(1500));
}

TEST(Playback, WaitsForThePictureAndForItsTime) {
  Playback playback;
  const TimePoint start{std::chrono::seconds(100)};
  playback.Toggle(0, 4);
  EXPECT_FALSE(playback.Advance(0, 4, false, start).has_value());
  EXPECT_EQ(playback.Advance(0, 4, true, start), 1);
  EXPECT_FALSE(playback.Advance(1, 4, true, start + milliseconds(400)).has_value());
  EXPECT_EQ(playback.Advance(3, 4, true, start + milliseconds(500)), 0);
  playback.loops = false;
  EXPECT_FALSE(playback.Advance(3, 4, true, start + milliseconds(1100)).has_value());
  EXPECT_FALSE(playback.playing());
  EXPECT_EQ(Playback::Step(0, -1, 4), 3);
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

class SessionStateTest : public ::testing::Test {
 protected:
  SessionStateTest() {
    state.link = Link::kLive;
    state.viewer_id = 7;
    state.role = v1::ROLE_VIEWER;
  }
  v1::SessionRules& rules() { return *state.presence.mutable_rules(); }

  SessionState state;
};

TEST_F(SessionStateTest, WhoSteersMayMarkWhateverTheRules) {
  rules().set_viewers_may_mark(false);
  EXPECT_FALSE(state.MayMark());
  state.presence.set_steering_viewer_id(7);
  EXPECT_TRUE(state.MayMark());
  state.presence.set_steering_viewer_id(3);
  EXPECT_FALSE(state.MayMark());
  rules().set_viewers_may_mark(true);
  EXPECT_TRUE(state.MayMark());
}

TEST_F(SessionStateTest, WhoAsksSteersOnlyWhileControlIsFree) {
  EXPECT_FALSE(state.SteersWhoAsks());
  rules().set_viewers_may_steer(true);
  EXPECT_TRUE(state.SteersWhoAsks());
  state.presence.set_presenter_away(true);
  EXPECT_FALSE(state.SteersWhoAsks()) << "an absent presenter keeps control";
  state.presence.set_presenter_away(false);
  state.presence.mutable_awaited()->set_viewer_id(5);
  EXPECT_FALSE(state.SteersWhoAsks()) << "nor is control free that waits for its holder";
  state.presence.clear_awaited();
  state.presence.set_steering_viewer_id(3);
  EXPECT_FALSE(state.SteersWhoAsks());
  state.presence.set_steering_viewer_id(0);
  rules().set_control_locked(true);
  EXPECT_FALSE(state.SteersWhoAsks());
}

const Parameter* Find(const std::vector<Parameter>& parameters, const std::string& path) {
  for (const Parameter& each : parameters) {
    if (each.path == path) return &each;
  }
  return nullptr;
}

TEST(SessionState, PutsMarksTogetherFromTheirChanges) {
  const auto mark = [](v1::Marks* marks, std::uint64_t id, std::uint64_t viewer_id) {
    marks->add_marks()->set_mark_id(id);
    marks->mutable_marks()->rbegin()->set_viewer_id(viewer_id);
  };
  SessionState state;
  v1::Marks all;
  for (std::uint64_t id = 1; id <= 3; ++id) mark(&all, id, 1);
  state.Take(all);
  EXPECT_EQ(state.marks.marks_size(), 3);
  v1::Marks change;
  change.set_only_changes(true);
  mark(&change, 2, 5);
  mark(&change, 4, 1);
  change.add_erased_mark_ids(1);
  change.add_erased_mark_ids(9);
  for (int times = 0; times < 2; ++times) {
    state.Take(change);
    ASSERT_EQ(state.marks.marks_size(), 3);
    EXPECT_EQ(state.marks.marks(0).mark_id(), 2U);
    EXPECT_EQ(state.marks.marks(0).viewer_id(), 5U);
    EXPECT_EQ(state.marks.marks(1).mark_id(), 3U);
    EXPECT_EQ(state.marks.marks(2).mark_id(), 4U);
  }
  state.Take(all);
  EXPECT_EQ(state.marks.marks(0).mark_id(), 1U);
}

TEST(Parameters, EveryScalarOfTheSceneIsListedWithItsLimits) {
  v1::Scene scene;
  scene.mutable_camera()->mutable_spotter();
  scene.add_fields()->set_hydrometeor(v1::HYDROMETEOR_RAIN);
  const auto parameters = ParametersOf(scene);
  const Parameter* const turbidity = Find(parameters, "sky.turbidity");
  ASSERT_NE(turbidity, nullptr);
  EXPECT_EQ(turbidity->limits.maximum, 10.0);
  EXPECT_EQ(turbidity->limits.default_value, 1.5);
  EXPECT_TRUE(turbidity->limits.logarithmic);
  EXPECT_NE(Find(parameters, "fields[0].phase.asymmetry"), nullptr);
  EXPECT_NE(Find(parameters, "camera.spotter.focal_length_mm"), nullptr);
  // Only the case of a oneof that is set is listed.
  EXPECT_EQ(Find(parameters, "camera.orbit.azimuth_deg"), nullptr);
  EXPECT_EQ(Find(parameters, "camera.spotter.focal_length_mm")->name, "Focal length");
  const Parameter* const tone = Find(parameters, "display.tone_map");
  ASSERT_NE(tone, nullptr);
  EXPECT_THAT(tone->options, ::testing::Contains(std::pair<int, std::string>(2, "filmic")));
  EXPECT_THAT(tone->options,
              ::testing::Contains(std::pair<int, std::string>(0, "default: filmic")));
  EXPECT_TRUE(Find(parameters, "display.white_balance")->default_on);
  EXPECT_FALSE(Find(parameters, "ground.rings")->default_on);
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

// A list element that was removed meanwhile must not be written.
TEST(Parameters, AnElementThatIsGoneStaysGone) {
  v1::Scene scene;
  scene.add_fields();
  const auto parameters = ParametersOf(scene);
  const Parameter& scale = *Find(parameters, "fields[0].scale");
  scene.clear_fields();
  SetNumber(scene, scale, 2.0);
  EXPECT_EQ(scene.fields_size(), 0);
  EXPECT_FALSE(NumberIn(scene, scale).has_value());
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
