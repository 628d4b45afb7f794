// Tests of a technique that only this file defines, registered as docs/extending.md describes: it
// is chosen by its name and drawn like any other.
#include <algorithm>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "frame/tone_map.h"
#include "gl/context.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "measure/probe.h"
#include "renderers/scene_renderer.h"
#include "tests/support/gl_context.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

using ::testing::HasSubstr;

// A technique that fills the picture with one grey in front of everything.
class Toy : public Technique {
 public:
  explicit Toy(Workspace& workspace) : workspace_(workspace) {}

  absl::Status MakeContent(const scene::Scene& scene, const Fields& /*fields*/,
                           StageTimes* /*times*/) override {
    const auto& settings = std::get<scene::OtherTechnique>(scene.rendering.technique);
    for (const auto& [name, value] : settings.numbers) {
      if (name != "level") {
        return absl::InvalidArgumentError(
            absl::StrCat("toy has no setting '", name, "'; it has level"));
      }
      level_ = static_cast<float>(value);
    }
    return absl::OkStatus();
  }

  bool Empty() const override { return false; }
  volume::WorldBox Box() const override { return {glm::dvec3(-1e3), glm::dvec3(1e3)}; }

  absl::Status CarryLight(const scene::Scene& /*scene*/, const Fields& /*fields*/,
                          const RenderSettings& /*settings*/, StageTimes* /*times*/) override {
    return absl::OkStatus();
  }
  bool CastsShadow() const override { return true; }

  absl::Status DrawView(const scene::Scene& /*scene*/, const RenderSettings& settings,
                        StageTimes* times) override {
    return Timed(workspace_.Pieces(), scene::FrameStage::kView, times, [&] {
      eye_ = gl::Texture2D(GL_RGBA32F, settings.eye_size);
      gl::Framebuffer(eye_).Clear(level_, level_, level_, 0.0F);
      return absl::OkStatus();
    });
  }
  const gl::Texture2D& Eye() const override { return eye_; }

  Content Describe(const scene::Scene& /*scene*/,
                   const volume::HydrometeorFields& /*fields*/) const override {
    return {.not_shown = {{scene::NotShown::Code::kStorm, "the storm"}}};
  }
  std::size_t Bytes() const override { return eye_.Bytes(); }

 protected:
  Workspace& workspace_;

 private:
  float level_ = 0.5F;
  gl::Texture2D eye_;
};

// The same technique in front of the storm's medium, whose shadow falls on the ground.
class ToyOfMedium final : public Toy {
 public:
  using Toy::Toy;

  bool DrawsMedium() const override { return true; }
  bool CastsShadow() const override { return false; }
  bool Empty() const override { return workspace_.medium.Empty(); }
  volume::WorldBox Box() const override { return BoxOf(workspace_.medium); }
  Content Describe(const scene::Scene& /*scene*/,
                   const volume::HydrometeorFields& fields) const override {
    return DescribeMedium(workspace_.medium, fields, false);
  }
};

class ToyOfMediumFactory final : public TechniqueFactory {
 public:
  std::string_view Name() const override { return "toy_of_medium"; }
  scene::Capabilities Capabilities() const override { return {}; }
  std::unique_ptr<Technique> Make(Workspace& workspace) const override {
    return std::make_unique<ToyOfMedium>(workspace);
  }
};

class ToyFactory final : public TechniqueFactory {
 public:
  std::string_view Name() const override { return "toy"; }
  scene::Capabilities Capabilities() const override { return {}; }
  std::unique_ptr<Technique> Make(Workspace& workspace) const override {
    return std::make_unique<Toy>(workspace);
  }
};

class ToyTechniqueTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    auto registry = std::make_shared<TechniqueRegistry>(TechniqueRegistry::BuiltIn());
    ASSERT_TRUE(registry->Add(std::make_shared<ToyFactory>()).ok());
    ASSERT_TRUE(registry->Add(std::make_shared<ToyOfMediumFactory>()).ok());
    renderer_ =
        std::make_unique<SceneRenderer>(std::make_shared<gl::ProgramCache>(), std::move(registry));
    scene_.output.width_px = 16;
    scene_.output.height_px = 8;
    // Only some two kilometres of clear air lie in front of the toy.
    scene_.camera = scene::OrbitCamera{.elevation_deg = 30.0, .distance_m = 2e3};
  }

  void TearDown() override { renderer_.reset(); }

  void Choose(const std::string& name, std::map<std::string, double> numbers = {}) {
    scene_.rendering.technique = scene::OtherTechnique{name, std::move(numbers)};
  }

  float MiddleRed() {
    const auto frame = renderer_->Draw(scene_, fields_, {});
    EXPECT_TRUE(frame.ok()) << frame.status();
    if (!frame.ok()) return -1.0F;
    const std::vector<float> pixels = frame::ReadLinear(*frame->radiance);
    return pixels[pixels.size() / 2];
  }

  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<SceneRenderer> renderer_;
  std::shared_ptr<const volume::HydrometeorFields> fields_ = measure::FieldsOf({});
  scene::Scene scene_ = test_support::PlainScene();
};

TEST_F(ToyTechniqueTest, IsChosenByItsNameAndDrawn) {
  Choose("toy");
  const auto frame = renderer_->Draw(scene_, fields_, {});
  ASSERT_TRUE(frame.ok()) << frame.status();
  ASSERT_EQ(frame->content.not_shown.size(), 1U);
  EXPECT_EQ(frame->content.not_shown[0].message, "the storm");
  // Two kilometres of clear air change a grey by a few hundredths.
  EXPECT_NEAR(MiddleRed(), 0.5F, 0.05F);
  Choose("toy", {{"level", 0.25}});
  EXPECT_NEAR(MiddleRed(), 0.25F, 0.05F);
  // Switches back to one of the program's own techniques, which shows the lit cloud.
  scene_.rendering.technique = scene::LightVolume{};
  const float cloud = MiddleRed();
  Choose("toy", {{"level", 2.0}});
  EXPECT_GT(MiddleRed(), 1.5F * cloud);
}

TEST_F(ToyTechniqueTest, MayDrawTheStormsMedium) {
  Choose("toy_of_medium");
  const auto frame = renderer_->Draw(scene_, fields_, {});
  ASSERT_TRUE(frame.ok()) << frame.status();
  EXPECT_THAT(frame->content.fields, testing::ElementsAre(physics::Hydrometeor::kCloud));
  // The toy's shadow is that of the medium, which no other technique computes.
  EXPECT_EQ(std::count_if(frame->stages.begin(), frame->stages.end(),
                          [](const scene::StageTime& time) {
                            return time.stage == scene::FrameStage::kGround;
                          }),
            1);
}

TEST_F(ToyTechniqueTest, RefusesASettingThatItDoesNotHave) {
  Choose("toy", {{"colour", 1.0}});
  EXPECT_THAT(std::string(renderer_->Draw(scene_, fields_, {}).status().message()),
              HasSubstr("no setting 'colour'"));
}

TEST_F(ToyTechniqueTest, LightsThatItDoesNotShowAreSaid) {
  Choose("toy");
  scene_.lights.emplace_back();
  const auto frame = renderer_->Draw(scene_, fields_, {});
  ASSERT_TRUE(frame.ok()) << frame.status();
  ASSERT_EQ(frame->content.not_shown.size(), 2U);
  EXPECT_EQ(frame->content.not_shown[1].code, scene::NotShown::Code::kLights);
}

TEST_F(ToyTechniqueTest, AnUnknownNameGetsTheListOfThoseThatDraw) {
  Choose("voxels");
  const absl::Status status = renderer_->Draw(scene_, fields_, {}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(std::string(status.message()),
            "no renderer draws the technique 'voxels'; choose one of: light_volume, half_angle, "
            "metaball, cumulus, toy, toy_of_medium");
  scene_.rendering.technique = scene::Reference{};  // traced, not drawn
  EXPECT_EQ(renderer_->Draw(scene_, fields_, {}).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(TechniqueRegistryTest, TakesEachNameOnce) {
  TechniqueRegistry registry = TechniqueRegistry::BuiltIn();
  EXPECT_TRUE(registry.Add(std::make_shared<ToyFactory>()).ok());
  EXPECT_EQ(registry.Add(std::make_shared<ToyFactory>()).code(), absl::StatusCode::kAlreadyExists);
  EXPECT_EQ(registry.All().size(), 6U);
  EXPECT_EQ(registry.Find("voxels"), nullptr);
}

}  // namespace
}  // namespace thunderhead::renderers
