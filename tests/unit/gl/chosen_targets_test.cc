#include "gl/chosen_targets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/captured_log.h"

namespace thunderhead::gl {
namespace {

TEST(ChosenTargets, AreRasterOrCompute) {
  const testing::CapturedLog log;
  EXPECT_EQ(ComputesByChoice("compute"), true);
  EXPECT_EQ(ComputesByChoice("raster"), false);
  EXPECT_EQ(ComputesByChoice(nullptr), std::nullopt);
  EXPECT_EQ(log.Text(), "");
}

TEST(ChosenTargets, AnotherTextIsNoChoiceAndIsReported) {
  for (const char* const text : {"", "Compute", "1"}) {
    const testing::CapturedLog log;
    EXPECT_EQ(ComputesByChoice(text), std::nullopt) << text;
    EXPECT_THAT(log.Text(), ::testing::HasSubstr("set it to raster or compute")) << text;
  }
}

}  // namespace
}  // namespace thunderhead::gl
