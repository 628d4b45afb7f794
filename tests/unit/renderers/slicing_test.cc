#include "renderers/half_angle/slicing.h"

#include <cmath>

#include "glm/geometric.hpp"
#include "gtest/gtest.h"
#include "scene/view.h"

namespace thunderhead::renderers {
namespace {

const LocalBox kBox{{500.0, 400.0, 100.0}};

// Returns the farthest extent of the box along a unit vector from its middle.
double Reach_m(const glm::dvec3& normal) { return glm::dot(glm::abs(normal), kBox.half_m); }

TEST(Slicing, SlicesFillTheBox) {
  for (double sun_deg : {0.0, 40.0, 89.0, 91.0, 179.0}) {
    const Slicing slicing =
        SliceBox(kBox, scene::Direction(sun_deg, 20), scene::Direction(0, 20), 200);
    EXPECT_EQ(slicing.count, 200);
    // Each slice represents half the spacing to either side.
    const double reach_m = Reach_m(slicing.normal);
    EXPECT_NEAR(slicing.Distance_m(0) + 0.5 * slicing.spacing_m, reach_m, 1e-9) << sun_deg;
    EXPECT_NEAR(slicing.Distance_m(199) - 0.5 * slicing.spacing_m, -reach_m, 1e-9) << sun_deg;
  }
}

TEST(Slicing, FacesHalfwayBetweenLightAndView) {
  const Slicing slicing = SliceBox(kBox, scene::Direction(30, 0), scene::Direction(-10, 0), 10);
  EXPECT_NEAR(glm::dot(slicing.normal, scene::Direction(10, 0)), 1.0, 1e-12);
  // The angle between the light and the normal is 20 degrees.
  EXPECT_NEAR(slicing.light_path_m, slicing.spacing_m / std::cos(20 * M_PI / 180), 1e-9);
}

TEST(Slicing, ReversesTheViewWhenTheSunIsBehindTheStorm) {
  const Slicing slicing = SliceBox(kBox, scene::Direction(30, 0), scene::Direction(170, 0), 10);
  EXPECT_NEAR(glm::dot(slicing.normal, scene::Direction(10, 0)), 1.0, 1e-12);
}

TEST(Slicing, DegenerateDirectionsStillSlice) {
  const glm::dvec3 sun = scene::Direction(0, 90);
  for (const glm::dvec3& eye : {sun, -sun, glm::dvec3(1, 0, 0)}) {
    const Slicing slicing = SliceBox(kBox, sun, eye, 1);
    EXPECT_NEAR(glm::length(slicing.normal), 1.0, 1e-12);
    EXPECT_NEAR(slicing.Distance_m(0), 0.0, 1e-9);
    EXPECT_NEAR(slicing.spacing_m, 2.0 * Reach_m(slicing.normal), 1e-9);
  }
}

TEST(Slicing, TheSunMeetsTheFirstSliceFirst) {
  const Slicing slicing = SliceBox(kBox, scene::Direction(0, 45), scene::Direction(90, 45), 10);
  EXPECT_GT(slicing.Distance_m(0), slicing.Distance_m(9));
  EXPECT_GT(glm::dot(slicing.normal, scene::Direction(0, 45)), 0.0);
}

TEST(Slicing, NarrowViewsMeetAllSlicesInOneOrderAndWideOnesInBoth) {
  scene::View view;
  view.forward = {1.0, 0.0, 0.0};
  view.right = {0.0, -1.0, 0.0};
  view.up = {0.0, 0.0, 1.0};
  const auto order = [&](double sun_azimuth_deg, double tan_half_width) {
    view.tan_half_width = tan_half_width;
    view.tan_half_height = 0.1;
    const glm::dvec3 sun = scene::Direction(sun_azimuth_deg, 0.0);
    return OrderOf(SliceBox(kBox, sun, -view.forward, 10), view);
  };
  // The view is to azimuth 90. If the sun is at a right angle to the view, the slices' normal is 45
  // degrees from the view's axis. Only a view that is wider than this to either side meets slices
  // in both orders.
  EXPECT_EQ(order(270.0, 0.5), SliceOrder::kAlong);
  EXPECT_EQ(order(91.0, 0.5), SliceOrder::kAgainst);
  EXPECT_EQ(order(181.0, 0.9), SliceOrder::kAlong);
  EXPECT_EQ(order(181.0, 1.1), SliceOrder::kBoth);
  EXPECT_EQ(order(179.0, 0.9), SliceOrder::kAgainst);
  EXPECT_EQ(order(179.0, 1.1), SliceOrder::kBoth);
}

}  // namespace
}  // namespace thunderhead::renderers
