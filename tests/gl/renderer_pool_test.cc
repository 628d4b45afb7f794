#include "renderers/renderer_pool.h"

#include <memory>
#include <string>
#include <vector>

#include "gl/context.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/gl_context.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing::Not;

class RendererPoolTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    scene_.output = {16, 16, 90};
    scene::SetSlices(&scene_.rendering.technique, 4);
  }

  std::vector<std::string> Stages(RendererPool& pool, const scene::Scene& scene) {
    const auto frame = pool.Draw(scene, fields_, {});
    EXPECT_TRUE(frame.ok()) << frame.status();
    std::vector<std::string> names;
    for (const scene::StageTime& stage : frame->stages)
      names.push_back(std::string(scene::NameOf(stage.stage)));
    return names;
  }

  // Returns a scene that shares no extinction with scenes of other scales.
  scene::Scene Scaled(float scale) const {
    scene::Scene scene = scene_;
    scene.fields[0].scale = scale;
    return scene;
  }

  std::unique_ptr<gl::Context> context_;
  std::shared_ptr<const volume::HydrometeorFields> fields_ =
      support::MakeSlab(4000.0, 2000.0, 0.01);
  scene::Scene scene_ = test_support::PlainScene();
};

TEST_F(RendererPoolTest, ViewersWhoAlternateKeepTheirStages) {
  RendererPool pool(2);
  EXPECT_THAT(Stages(pool, Scaled(1.0F)), Contains("extinction"));
  EXPECT_THAT(Stages(pool, Scaled(2.0F)), Contains("extinction"));
  EXPECT_THAT(Stages(pool, Scaled(1.0F)), IsEmpty());
  EXPECT_THAT(Stages(pool, Scaled(2.0F)), IsEmpty());
}

TEST_F(RendererPoolTest, SunsOfOneStormShareItsExtinction) {
  RendererPool pool(2);
  (void)Stages(pool, scene_);
  scene_.sun.elevation_deg += 10.0;
  EXPECT_THAT(Stages(pool, scene_), Not(Contains("extinction")));
}

TEST_F(RendererPoolTest, TheLeastRecentlyUsedGoesFirst) {
  RendererPool pool(2);
  for (const float scale : {1.0F, 2.0F, 1.0F, 3.0F}) (void)Stages(pool, Scaled(scale));
  EXPECT_THAT(Stages(pool, Scaled(1.0F)), IsEmpty());
  EXPECT_THAT(Stages(pool, Scaled(2.0F)), Contains("extinction"));
}

TEST_F(RendererPoolTest, TheDevicesBytesAreBounded) {
  RendererPool pool(4, 1);
  EXPECT_THAT(Stages(pool, Scaled(1.0F)), Contains("extinction"));
  EXPECT_THAT(Stages(pool, Scaled(2.0F)), Contains("extinction"));
  EXPECT_THAT(Stages(pool, Scaled(1.0F)), Contains("extinction"));
}

}  // namespace
}  // namespace thunderhead::renderers
