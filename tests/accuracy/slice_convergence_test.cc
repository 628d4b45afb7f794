// Tests of the orders of convergence of the transports kPaper and kConsistent with the number of
// slices.
#include "measure/slice_convergence.h"

#include <memory>

#include "gtest/gtest.h"
#include "measure/probe.h"
#include "scene/view.h"
#include "tests/support/gl_context.h"
#include "tests/support/techniques.h"

namespace thunderhead::measure {
namespace {

TEST(SliceConvergence, OrderOfAPowerLaw) {
  EXPECT_NEAR(OrderOf({{10, 0.9}, {20, 0.45}, {40, 0.225}}), 1.0, 1e-12);
  EXPECT_NEAR(OrderOf({{8, 0.64}, {16, 0.16}, {64, 0.01}}), 2.0, 1e-12);
  // The last value is at the rounding error of the frame's half floats.
  EXPECT_NEAR(OrderOf({{8, 0.64}, {16, 0.16}, {1024, 3e-4}}), 2.0, 1e-12);
}

TEST(SliceConvergence, PaperIsFirstOrderConsistentSecond) {
  auto context = test_support::OpenContext();
  ASSERT_TRUE(context.ok()) << context.status();
  scene::Scene scene = test_support::PlainScene();
  test_support::SetTechnique(&scene.rendering.technique, test_support::kHalfAngle);
  scene.output = {48, 48, 88};
  scene.sun = {255.0, 35.0};
  scene.sky = {0.0, 0.0};
  const auto fields = SmoothCloud(5.0);
  scene.camera = scene::Framing(scene::OrbitCamera(), fields->grid.low_corner_m,
                                fields->grid.HighCorner_m(), 1.0);
  const auto curves = MeasureSliceConvergence(scene, fields, [](double) {});
  ASSERT_TRUE(curves.ok()) << curves.status();
  ASSERT_EQ(curves->size(), 2U);
  // The transport as printed in the paper (Riley et al. 2003 (Vis)) adds an error of (1 - T)^2 per
  // slice. With twice as many slices, the total error is half as large.
  EXPECT_EQ(curves->front().transport.name, "paper");
  EXPECT_NEAR(curves->front().order, 1.0, 0.15);
  EXPECT_EQ(curves->back().transport.name, "consistent");
  EXPECT_NEAR(curves->back().order, 2.0, 0.3);
}

}  // namespace
}  // namespace thunderhead::measure
