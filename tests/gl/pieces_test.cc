// Tests of pictures drawn in pieces, compared with the same pictures drawn whole.
#include "gl/pieces.h"

#include <functional>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "frame/tone_map.h"
#include "gl/context.h"
#include "gtest/gtest.h"
#include "renderers/scene_renderer.h"
#include "scene/view.h"
#include "storm_store/storm_store.h"
#include "tests/support/gl_context.h"
#include "tests/support/techniques.h"

namespace thunderhead {
namespace {

// A turn that counts the pieces and refuses one.
class CountedTurn final : public base::DeviceTurn {
 public:
  absl::Status Take() override {
    EXPECT_FALSE(held_) << "taken twice";
    if (++taken_ == refused_ || (refuses_ && refuses_())) {
      return absl::CancelledError("nobody wants it");
    }
    held_ = true;
    return absl::OkStatus();
  }
  void GiveBack() override {
    EXPECT_TRUE(held_);
    held_ = false;
  }

  void Refuse(int piece) { refused_ = taken_ + piece; }
  // Refuses every piece for which `refuses` returns true; null refuses none.
  void RefuseIf(std::function<bool()> refuses) { refuses_ = std::move(refuses); }
  int Taken() const { return taken_; }
  bool IsHeld() const { return held_; }

 private:
  bool held_ = false;
  int taken_ = 0;
  int refused_ = -1;
  std::function<bool()> refuses_;
};

// Returns a scene of each technique, with the sun in the picture and lit ground.
std::vector<std::pair<std::string, scene::Technique>> Techniques() {
  const auto light_volume = [](scene::Transport transport, int slices) {
    scene::Technique technique = scene::LightVolume{};
    test_support::SetTransport(&technique, transport);
    scene::SetSlices(&technique, slices);
    return technique;
  };
  scene::HalfAngle half_angle;
  half_angle.slices = 96;
  scene::Metaballs metaballs;
  metaballs.count = 300;
  return {{"diffusion", light_volume(scene::Transport::kDiffusion, 192)},
          {"consistent", light_volume(scene::Transport::kConsistent, 192)},
          {"half-angle", half_angle},
          {"metaballs", metaballs},
          {"cumulus", scene::Cumulus()}};
}

class PiecesTest : public testing::Test {
 protected:
  // A drawing with its own renderer.
  struct Drawing {
    explicit Drawing(base::DeviceTurn* turn)
        : programs(std::make_shared<gl::ProgramCache>(turn)),
          renderer(programs),
          tone_mapper(programs) {}

    absl::StatusOr<std::vector<float>> Draw(
        const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields) {
      return programs->Pieces().During([&]() -> absl::StatusOr<std::vector<float>> {
        auto frame = renderer.Draw(scene, fields, {});
        if (!frame.ok()) return frame.status();
        auto mapped = tone_mapper.Map(*frame->radiance, scene);
        if (!mapped.ok()) return mapped.status();
        rgb = mapped->rgb;
        auto with_more_bits = tone_mapper.MapFine(*frame->radiance);
        if (!with_more_bits.ok()) return with_more_bits.status();
        fine = with_more_bits->rgb;
        return frame::ReadLinear(*frame->radiance, programs->Pieces());
      });
    }

    std::shared_ptr<gl::ProgramCache> programs;
    renderers::SceneRenderer renderer;
    frame::ToneMapper tone_mapper;
    std::vector<std::uint8_t> rgb;
    std::vector<std::uint16_t> fine;
  };

  // A picture that was drawn whole.
  struct Picture {
    std::vector<float> radiance;
    std::vector<std::uint8_t> rgb;
    std::vector<std::uint16_t> fine;
  };

  static void SetUpTestSuite() {
    auto store = storm_store::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc"},
                                               {.read_ahead = 0});
    ASSERT_TRUE(store.ok()) << store.status();
    auto fields = (*store)->Get("supercell", 1, {});
    ASSERT_TRUE(fields.ok()) << fields.status();
    fields_ = *fields;
  }
  static void TearDownTestSuite() {
    fields_.reset();
    wholes_.clear();
  }

  void SetUp() override {
    ASSERT_NE(fields_, nullptr);
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    scene_.output = {323, 181, 90};
    auto& orbit = std::get<scene::OrbitCamera>(scene_.camera);
    orbit.distance_m = 60e3;
    orbit.elevation_deg = 8.0;
    scene_.sun.elevation_deg = 20.0;
    // The sun is behind the storm, so its disc and aureole are in the picture.
    scene_.sun.azimuth_deg = orbit.azimuth_deg + 180.0;
  }

  // Returns the picture by that technique. It is drawn for the first test that asks for it.
  const Picture& Whole(const std::string& name) {
    const auto known = wholes_.find(name);
    if (known != wholes_.end()) return known->second;
    Drawing whole(nullptr);
    const auto radiance = whole.Draw(scene_, fields_);
    EXPECT_TRUE(radiance.ok()) << radiance.status();
    if (!radiance.ok()) return wholes_[name];
    return wholes_[name] = {*radiance, whole.rgb, whole.fine};
  }

  inline static std::shared_ptr<const volume::HydrometeorFields> fields_;
  inline static std::map<std::string, Picture> wholes_;
  std::unique_ptr<gl::Context> context_;
  scene::Scene scene_;
};

TEST_F(PiecesTest, PicturesAreTheSameToTheLastBit) {
  for (const auto& [name, technique] : Techniques()) {
    SCOPED_TRACE(name);
    scene_.rendering.technique = technique;
    const Picture& whole = Whole(name);
    CountedTurn turn;
    Drawing cut(&turn);
    const auto in_pieces = cut.Draw(scene_, fields_);
    ASSERT_TRUE(in_pieces.ok()) << in_pieces.status();
    EXPECT_GT(turn.Taken(), 8) << "not cut";
    EXPECT_TRUE(*in_pieces == whole.radiance);
    EXPECT_TRUE(cut.rgb == whole.rgb);
    EXPECT_TRUE(cut.fine == whole.fine);
    EXPECT_FALSE(turn.IsHeld());
  }
}

TEST_F(PiecesTest, WhatIsCancelledEndsAtTheNextPieceAndIsDrawnRightAfterwards) {
  for (const auto& [name, technique] : Techniques()) {
    SCOPED_TRACE(name);
    scene_.rendering.technique = technique;
    const Picture& whole = Whole(name);
    CountedTurn turn;
    Drawing cut(&turn);
    for (const int piece : {1, 3, 6, 9, 12}) {
      turn.Refuse(piece);
      const int before = turn.Taken();
      const auto cancelled = cut.Draw(scene_, fields_);
      if (cancelled.ok()) break;  // the picture has fewer pieces
      EXPECT_TRUE(absl::IsCancelled(cancelled.status())) << cancelled.status();
      EXPECT_EQ(turn.Taken(), before + piece);
      EXPECT_FALSE(turn.IsHeld());
      EXPECT_EQ(glIsEnabled(GL_SCISSOR_TEST), GL_FALSE);
      EXPECT_EQ(glIsEnabled(GL_DEPTH_TEST), GL_FALSE);
      EXPECT_EQ(glIsEnabled(GL_BLEND), GL_FALSE);
    }
    turn.Refuse(-1);
    const auto again = cut.Draw(scene_, fields_);
    ASSERT_TRUE(again.ok()) << again.status();
    EXPECT_TRUE(*again == whole.radiance);
  }
}

TEST_F(PiecesTest, WhatIsCancelledWithinItsViewKeepsItsLight) {
  for (const auto& [name, technique] : Techniques()) {
    SCOPED_TRACE(name);
    scene_.rendering.technique = technique;
    const Picture& whole = Whole(name);
    CountedTurn turn;
    Drawing cut(&turn);
    const auto draw = [&] {
      return cut.programs->Pieces().During([&] { return cut.renderer.Draw(scene_, fields_, {}); });
    };
    turn.RefuseIf([&] { return cut.renderer.FirstStage(scene_, fields_) >= scene::Stage::kView; });
    const absl::Status cancelled = draw().status();
    EXPECT_TRUE(absl::IsCancelled(cancelled)) << cancelled;
    turn.RefuseIf(nullptr);
    ASSERT_GE(cut.renderer.FirstStage(scene_, fields_), scene::Stage::kView);
    const auto again = draw();
    ASSERT_TRUE(again.ok()) << again.status();
    for (const scene::StageTime& stage : again->stages) {
      EXPECT_NE(stage.stage, scene::FrameStage::kExtinction);
      EXPECT_NE(stage.stage, scene::FrameStage::kLight);
    }
    EXPECT_TRUE(frame::ReadLinear(*again->radiance) == whole.radiance);
  }
}

TEST_F(PiecesTest, StagesDoNotCountTheTimeThatTheyWaited) {
  // Other work has its turn before each piece. A wait is much longer than the drawing time that
  // belongs to no stage, so a stage that counted one wait would exceed the limit.
  class SlowTurn final : public base::DeviceTurn {
   public:
    absl::Status Take() override {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      ++taken;
      return absl::OkStatus();
    }
    void GiveBack() override {}
    int taken = 0;
  } turn;
  Drawing cut(&turn);
  const base::Stopwatch stopwatch;
  const auto frame =
      cut.programs->Pieces().During([&] { return cut.renderer.Draw(scene_, fields_, {}); });
  ASSERT_TRUE(frame.ok()) << frame.status();
  double stages_ms = 0.0;
  for (const scene::StageTime& stage : frame->stages) stages_ms += stage.milliseconds;
  EXPECT_GT(turn.taken, 4);
  EXPECT_LT(stages_ms, stopwatch.ElapsedMs() - 50.0 * turn.taken + 1.0);
}

TEST_F(PiecesTest, WorkThatThrowsGivesTheTurnBack) {
  CountedTurn turn;
  gl::Pieces pieces(&turn);
  EXPECT_THROW(static_cast<void>(pieces.During([]() -> absl::Status { throw std::bad_alloc(); })),
               std::bad_alloc);
  EXPECT_FALSE(turn.IsHeld());
}

TEST_F(PiecesTest, ASecondContextOutlivesTheFirst) {
  std::thread([] {
    const auto other = test_support::OpenContext();
    EXPECT_TRUE(other.ok()) << other.status();
  }).join();
  CountedTurn turn;
  Drawing cut(&turn);
  EXPECT_TRUE(cut.Draw(scene_, fields_).ok());
}

}  // namespace
}  // namespace thunderhead
