// Tests of pictures when the graphics device runs out of memory or is lost, with a real OpenGL
// context.
#include "gl/device_memory.h"

#include <deque>
#include <memory>

#include "base/error_details.h"
#include "base/guarded.h"
#include "drawing/gl_frame_source.h"
#include "gl/context.h"
#include "gl/device_faults.h"
#include "gl/objects.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/gl_context.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"

namespace thunderhead::gl {
namespace {

using base::MemoryBudget;
using base::MemoryUse;
using Fault = DeviceWatch::Fault;

constexpr std::size_t kTextureBytes = 64 * 64 * 8;

Texture2D MakeTexture() { return Texture2D(GL_RGBA16F, glm::ivec2(64)); }

TEST(DeviceMemoryTest, ObjectsCountAsLongAsTheyLive) {
  const auto context = test_support::OpenContext();
  ASSERT_TRUE(context.ok()) << context.status();
  const auto budget = MemoryBudget::Unlimited();
  const DeviceMemory memory(budget, [] { return false; });
  {
    Texture2D texture = MakeTexture();
    const Texture3D volume(GL_R16F, glm::ivec3(8));
    const Texture2DArray array(GL_RG32F, glm::ivec2(4), 3);
    const Buffer buffer(1000, nullptr, 0);
    const Texture2D mips = Texture2D::WithMips(GL_RGBA8, glm::ivec2(64), Edge::kClamp);
    const std::size_t others = volume.Bytes() + array.Bytes() + buffer.Bytes() + mips.Bytes();
    EXPECT_EQ(others, 8U * 8 * 8 * 2 + 4 * 4 * 8 * 3 + 1000 + 64 * 64 * 4 * 4 / 3);
    EXPECT_EQ(budget->Used(MemoryUse::kDrawing), others + kTextureBytes);
    texture = Texture2D();
    EXPECT_EQ(budget->Used(MemoryUse::kDrawing), others);
  }
  EXPECT_EQ(budget->Used(), 0U);
}

TEST(DeviceMemoryTest, WhatIsUnusedGoesFirstAndThenTheObjectIsRefused) {
  const auto context = test_support::OpenContext();
  ASSERT_TRUE(context.ok()) << context.status();
  const auto budget = MemoryBudget::Make({.bytes = 3 * kTextureBytes});
  std::deque<Texture2D> unused;
  const DeviceMemory memory(budget, [&] {
    if (unused.empty()) return false;
    unused.pop_front();
    return true;
  });
  for (int i = 0; i < 2; ++i) unused.push_back(MakeTexture());
  std::vector<Texture2D> used;
  for (int i = 0; i < 3; ++i) used.push_back(MakeTexture());
  EXPECT_TRUE(unused.empty());
  const absl::Status refused = base::Guarded([&]() -> absl::Status {
    used.push_back(MakeTexture());
    return absl::OkStatus();
  });
  EXPECT_EQ(base::DetailsOf(refused).reason, "MEMORY_BUDGET") << refused;
  EXPECT_EQ(used.size(), 3U);
}

// A watch that reports the given faults, each once.
class ToldWatch final : public DeviceWatch {
 public:
  explicit ToldWatch(std::shared_ptr<std::deque<Fault>> faults) : faults_(std::move(faults)) {}

  Fault Look() override {
    if (faults_->empty()) return Fault::kNone;
    const Fault fault = faults_->front();
    faults_->pop_front();
    return fault;
  }

 private:
  const std::shared_ptr<std::deque<Fault>> faults_;
};

class FaultySource : public ::testing::Test {
 protected:
  void Open(drawing::GlSourceOptions options = {}) {
    options.watch_device = [faults = faults_] { return std::make_unique<ToldWatch>(faults); };
    auto source = drawing::GlFrameSources(test_support::Device(), std::move(options))(nullptr);
    ASSERT_TRUE(source.ok()) << source.status();
    source_ = *std::move(source);
    scene_.output = {32, 16, 90};
    scene::SetSlices(&scene_.rendering.technique, 4);
  }

  absl::Status Draw() { return source_->Draw(scene_, fields_, {}).status(); }

  const std::shared_ptr<std::deque<Fault>> faults_ = std::make_shared<std::deque<Fault>>();
  std::unique_ptr<drawing::FrameSource> source_;
  scene::Scene scene_ = test_support::PlainScene();
  const std::shared_ptr<const volume::HydrometeorFields> fields_ =
      support::MakeSlab(4000.0, 2000.0, 0.01);
};

TEST_F(FaultySource, SaysThatItsDeviceIsLost) {
  Open();
  faults_->assign({Fault::kLost});
  EXPECT_TRUE(IsDeviceLost(Draw()));
}

TEST_F(FaultySource, DrawsAgainWhereTheDeviceWasFullOnce) {
  Open();
  ASSERT_TRUE(Draw().ok());
  faults_->assign({Fault::kOutOfMemory});
  scene_.sun.azimuth_deg += 10.0;
  EXPECT_TRUE(Draw().ok());
}

TEST_F(FaultySource, RefusesAPictureForWhichTheDeviceStaysFullAndGoesOn) {
  Open();
  faults_->assign({Fault::kOutOfMemory, Fault::kOutOfMemory});
  const absl::Status refused = Draw();
  EXPECT_TRUE(absl::IsResourceExhausted(refused)) << refused;
  EXPECT_EQ(base::DetailsOf(refused).reason, "OUT_OF_DEVICE_MEMORY");
  EXPECT_TRUE(Draw().ok());
}

TEST_F(FaultySource, GivesBackWhatItKeepsAndWhatItCouldNotFinish) {
  const auto budget = MemoryBudget::Make({.bytes = std::size_t{1} << 30U});
  Open({.memory = budget, .gpu_memory = budget});
  ASSERT_TRUE(Draw().ok());
  const std::size_t drawn = budget->Used();
  EXPECT_GT(drawn, 0U);
  source_->FreeUnused(0.0);
  const std::size_t kept = budget->Used();
  EXPECT_LT(kept, drawn / 2);
  // Leaves too little memory for another picture.
  const auto others =
      budget->Reserve(MemoryUse::kDrawing, budget->Bytes() - budget->Used() - drawn / 4, "it");
  ASSERT_TRUE(others.ok());
  const std::size_t before = budget->Used();
  const absl::Status refused = Draw();
  EXPECT_EQ(base::DetailsOf(refused).reason, "MEMORY_BUDGET") << refused;
  EXPECT_LE(budget->Used(), before + drawn / 100);
}

TEST(WatchDeviceTest, SeesNoFaultInAContextThatIsWell) {
  const auto context = test_support::OpenContext();
  ASSERT_TRUE(context.ok()) << context.status();
  EXPECT_EQ(WatchDevice()->Look(), Fault::kNone);
  // An invalid OpenGL call by the program itself is not a device fault.
  glEnable(GL_RGBA8);
  EXPECT_EQ(WatchDevice()->Look(), Fault::kNone);
}

TEST(ContextTest, TellsOfLossWhereTheDriverOffersIt) {
  const auto context = test_support::OpenContext();
  ASSERT_TRUE(context.ok()) << context.status();
  GLint strategy = GL_NO_RESET_NOTIFICATION;
  glGetIntegerv(GL_RESET_NOTIFICATION_STRATEGY, &strategy);
  EXPECT_EQ((*context)->Info().tells_of_loss, strategy == GL_LOSE_CONTEXT_ON_RESET);
}

}  // namespace
}  // namespace thunderhead::gl
