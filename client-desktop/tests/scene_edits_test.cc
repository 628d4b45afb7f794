// Tests of scene edits, and of undoing them after another viewer has changed the scene.
#include "desktop/scene_edits.h"

#include <google/protobuf/util/message_differencer.h>

#include "desktop/history.h"
#include "desktop/scene_change.h"
#include "gtest/gtest.h"

namespace thunderhead::desktop {
namespace {

using google::protobuf::util::MessageDifferencer;
using std::chrono::milliseconds;

v1::Scene AScene() {
  v1::Scene scene;
  scene.set_storm_id("moore");
  scene.set_time_index(3);
  scene.mutable_camera()->mutable_orbit()->set_azimuth_deg(200.0F);
  scene.mutable_sun()->set_source(v1::Sun::SOURCE_BY_TIME);
  scene.mutable_sun()->mutable_clock()->set_date_time("2013-05-20T20:00:00Z");
  scene.mutable_sky()->set_turbidity(3.0F);
  v1::FieldParameters& rain = *scene.add_fields();
  rain.set_hydrometeor(v1::HYDROMETEOR_RAIN);
  rain.set_visible(false);
  rain.set_radius_m(1e-3F);
  return scene;
}

TEST(ChooseStorm, KeepsNothingOfTheOldStorms) {
  v1::Scene scene = AScene();
  ChooseStorm(scene, "supercell");
  EXPECT_EQ(scene.storm_id(), "supercell");
  EXPECT_FALSE(scene.has_time_index());
  EXPECT_FALSE(scene.has_camera());
  EXPECT_FALSE(scene.sun().has_clock());
  EXPECT_EQ(scene.fields_size(), 0);
  EXPECT_EQ(scene.sun().source(), v1::Sun::SOURCE_BY_TIME);
  EXPECT_EQ(scene.sky().turbidity(), 3.0F);
}

TEST(ChooseStorm, ChangesNothingWhereItIsShown) {
  v1::Scene scene = AScene();
  ChooseStorm(scene, "moore");
  EXPECT_TRUE(MessageDifferencer::Equals(scene, AScene()));
}

TEST(ChoosePreset, AlsoSaysWhereSizesComeFrom) {
  v1::Scene scene;
  scene.set_particle_sizes(v1::PARTICLE_SIZES_PAPERS);
  scene.mutable_accuracy()->set_max_error(0.1F);
  ChoosePreset(scene, v1::PRESET_ACCURATE);
  EXPECT_EQ(scene.rendering().preset(), v1::PRESET_ACCURATE);
  EXPECT_EQ(scene.particle_sizes(), v1::PARTICLE_SIZES_MODEL);
  EXPECT_FALSE(scene.has_accuracy());
  ChoosePreset(scene, v1::PRESET_UNIFORM_PHASE_TRANSLUCENT);
  EXPECT_EQ(scene.particle_sizes(), v1::PARTICLE_SIZES_PAPERS);
}

TEST(ChooseGoal, IsOneOfTwoOrNone) {
  v1::Scene scene = AScene();
  ChooseGoal(scene, v1::Accuracy::kMaxError);
  EXPECT_EQ(scene.accuracy().max_error(), 0.5F);
  ChooseGoal(scene, v1::Accuracy::kMaxMilliseconds);
  EXPECT_EQ(scene.accuracy().limit_case(), v1::Accuracy::kMaxMilliseconds);
  EXPECT_EQ(scene.accuracy().max_milliseconds(), 100.0F);
  ChooseGoal(scene, v1::Accuracy::LIMIT_NOT_SET);
  EXPECT_FALSE(scene.has_accuracy());
}

TEST(PresetOf, IsFoundByItsSettingsUnlessAGoalOverridesIt) {
  v1::GetServerInfoResponse server;
  v1::PresetDescription& fast = *server.add_presets();
  fast.set_preset(v1::PRESET_FAST);
  fast.mutable_rendering()->mutable_light_volume();
  v1::PresetDescription& papers = *server.add_presets();
  papers.set_preset(v1::PRESET_UNIFORM_PHASE_LOW_ALBEDO);
  papers.mutable_rendering()->mutable_half_angle();
  v1::Scene scene;
  scene.mutable_rendering()->set_preset(v1::PRESET_ACCURATE);
  EXPECT_EQ(PresetOf(scene, server), v1::PRESET_ACCURATE);
  *scene.mutable_rendering() = papers.rendering();
  EXPECT_EQ(PresetOf(scene, server), v1::PRESET_UNIFORM_PHASE_LOW_ALBEDO);
  ChooseGoal(scene, v1::Accuracy::kMaxError);
  EXPECT_EQ(PresetOf(scene, server), v1::PRESET_UNSPECIFIED);
  ChooseGoal(scene, v1::Accuracy::LIMIT_NOT_SET);
  scene.mutable_rendering()->mutable_half_angle()->set_detail(true);
  EXPECT_EQ(PresetOf(scene, server), v1::PRESET_UNSPECIFIED);
}

TEST(ChooseParticleSizes, HoldsForFieldsThatHadSizesOfTheirOwn) {
  v1::Scene scene = AScene();
  scene.mutable_fields(0)->set_sizes(v1::PARTICLE_SIZES_GIVEN);
  ChooseParticleSizes(scene, v1::PARTICLE_SIZES_PAPERS);
  EXPECT_EQ(scene.particle_sizes(), v1::PARTICLE_SIZES_PAPERS);
  EXPECT_EQ(scene.fields(0).sizes(), v1::PARTICLE_SIZES_UNSPECIFIED);
  EXPECT_FALSE(scene.fields(0).has_radius_m());
  EXPECT_FALSE(scene.fields(0).visible());
}

class HistoryTest : public ::testing::Test {
 protected:
  // Makes and records a change by this window.
  template <typename Edit>
  void Change(const Edit& edit, const std::string& subject = "some") {
    const v1::Scene before = scene;
    edit(scene);
    history.Record(before, scene, subject, now);
    now += milliseconds(100);
  }
  void ChangeTime(std::uint32_t index) {
    Change([=](v1::Scene& changed) { changed.set_time_index(index); }, "time");
  }
  bool Undo() { return Make(history.Undo()); }
  bool Redo() { return Make(history.Redo()); }
  bool Make(const std::optional<History::Edit>& step) {
    if (step) (*step)(scene);
    return step.has_value();
  }
  void Pause() { now += std::chrono::seconds(1); }

  v1::Scene scene = AScene();
  History history;
  History::TimePoint now{std::chrono::seconds(100)};
};

TEST_F(HistoryTest, OneDragIsOneStep) {
  ChangeTime(4);
  ChangeTime(5);
  EXPECT_TRUE(history.IsOpen(now));
  Pause();
  EXPECT_FALSE(history.IsOpen(now));
  ChangeTime(6);
  EXPECT_TRUE(history.IsOpen(now));
  EXPECT_TRUE(Undo());
  EXPECT_FALSE(history.IsOpen(now)) << "what comes after an undo is another step";
  EXPECT_EQ(scene.time_index(), 5U);
  EXPECT_TRUE(Undo());
  EXPECT_TRUE(MessageDifferencer::Equals(scene, AScene()));
  EXPECT_FALSE(Undo());
  EXPECT_TRUE(Redo());
  EXPECT_TRUE(Redo());
  EXPECT_EQ(scene.time_index(), 6U);
  EXPECT_FALSE(Redo());
}

TEST_F(HistoryTest, ChangesOfOthersStay) {
  ChangeTime(4);
  Pause();
  Change([](v1::Scene& changed) {
    changed.mutable_sun()->set_azimuth_deg(10.0F);
    changed.mutable_fields(0)->set_scale(2.0F);
  });
  scene.mutable_sky()->set_turbidity(5.0F);
  scene.mutable_sun()->set_elevation_deg(30.0F);
  scene.mutable_fields(0)->set_visible(true);
  EXPECT_TRUE(Undo());
  EXPECT_FALSE(scene.sun().has_azimuth_deg());
  EXPECT_FALSE(scene.fields(0).has_scale());
  EXPECT_EQ(scene.time_index(), 4U);
  const auto others_stay = [&] {
    EXPECT_EQ(scene.sky().turbidity(), 5.0F);
    EXPECT_EQ(scene.sun().elevation_deg(), 30.0F);
    EXPECT_TRUE(scene.fields(0).visible());
  };
  others_stay();
  EXPECT_TRUE(Redo());
  EXPECT_EQ(scene.sun().azimuth_deg(), 10.0F);
  EXPECT_EQ(scene.fields(0).scale(), 2.0F);
  others_stay();
}

// Another viewer changes the scene in the middle of this window's gesture.
TEST_F(HistoryTest, ChangesOfOthersDuringAGestureStay) {
  ChangeTime(4);
  scene.mutable_sky()->set_turbidity(5.0F);
  ChangeTime(5);
  EXPECT_TRUE(Undo());
  EXPECT_EQ(scene.time_index(), 3U);
  EXPECT_EQ(scene.sky().turbidity(), 5.0F);
  EXPECT_FALSE(Undo());
}

TEST_F(HistoryTest, AnotherStormAndBack) {
  Change([](v1::Scene& changed) { ChooseStorm(changed, "supercell"); });
  // These are values that the server fills in when it completes the scene.
  scene.set_time_index(0);
  scene.mutable_sun()->mutable_clock()->set_latitude_deg(40.0);
  scene.add_fields()->set_hydrometeor(v1::HYDROMETEOR_CLOUD);
  scene.add_fields()->set_hydrometeor(v1::HYDROMETEOR_ICE);
  EXPECT_TRUE(Undo());
  EXPECT_EQ(scene.storm_id(), "moore");
  EXPECT_EQ(scene.time_index(), 3U);
  EXPECT_EQ(scene.camera().orbit().azimuth_deg(), 200.0F);
  EXPECT_EQ(scene.sun().clock().date_time(), "2013-05-20T20:00:00Z");
  ASSERT_EQ(scene.fields_size(), 1);
  EXPECT_FALSE(scene.fields(0).visible());
}

TEST_F(HistoryTest, OneMoreThanAHundredStepsForgetsTheFirst) {
  for (std::uint32_t i = 0; i < 101; ++i) {
    ChangeTime(10 + i);
    Pause();
  }
  int undone = 0;
  while (Undo()) ++undone;
  EXPECT_EQ(undone, 100);
  EXPECT_EQ(scene.time_index(), 10U);
}

TEST_F(HistoryTest, ClearedItHasNoSteps) {
  ChangeTime(4);
  Pause();
  ChangeTime(5);
  EXPECT_TRUE(Undo());
  history.Clear();
  EXPECT_FALSE(Undo());
  EXPECT_FALSE(Redo());
  ChangeTime(6);
  EXPECT_TRUE(Undo());
  EXPECT_EQ(scene.time_index(), 4U);
}

TEST(SceneChange, DefaultsThatAreSetDifferFromAbsence) {
  v1::Scene from;
  v1::Scene to;
  to.set_time_index(0);
  v1::Scene present;
  present.set_time_index(5);
  MakeChange(from, to, present);
  EXPECT_TRUE(present.has_time_index());
  EXPECT_EQ(present.time_index(), 0U);
  MakeChange(to, from, present);
  EXPECT_FALSE(present.has_time_index());
}

TEST(SceneChange, AOneofIsOneValue) {
  v1::Scene from;
  from.mutable_camera()->mutable_orbit()->set_azimuth_deg(10.0F);
  v1::Scene to;
  to.mutable_camera()->mutable_spotter()->set_x_m(100.0F);
  v1::Scene present = from;
  present.mutable_camera()->mutable_orbit()->set_distance_m(5000.0F);
  MakeChange(from, to, present);
  EXPECT_TRUE(MessageDifferencer::Equals(present, to));
}

TEST(SceneChange, AListOfAnotherLengthIsSomebodyElses) {
  v1::Scene from;
  from.add_lights()->set_azimuth_deg(1.0F);
  v1::Scene to = from;
  to.mutable_lights(0)->set_azimuth_deg(2.0F);
  v1::Scene present = to;
  present.add_lights();
  MakeChange(to, from, present);
  EXPECT_EQ(present.lights(0).azimuth_deg(), 2.0F);
  present.mutable_lights()->RemoveLast();
  MakeChange(to, from, present);
  EXPECT_EQ(present.lights(0).azimuth_deg(), 1.0F);
}

TEST(SceneChange, APartIsAbsentAgainUnlessSomebodyElseHasFilledIt) {
  const v1::Scene empty;
  v1::Scene full;
  full.mutable_ground()->set_rings(true);
  v1::Scene present = full;
  MakeChange(full, empty, present);
  EXPECT_FALSE(present.has_ground());
  present = full;
  present.mutable_ground()->set_cover(v1::Ground::COVER_FIELDS);
  MakeChange(full, empty, present);
  EXPECT_FALSE(present.ground().has_rings());
  EXPECT_EQ(present.ground().cover(), v1::Ground::COVER_FIELDS);
}

}  // namespace
}  // namespace thunderhead::desktop
