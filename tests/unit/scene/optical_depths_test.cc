#include "scene/optical_depths.h"

#include <vector>

#include "gtest/gtest.h"
#include "storm_store/storm_store.h"

namespace thunderhead::scene {
namespace {

TEST(OpticalDepths, OnlyTechniquesThatDrawAMediumHaveItsDetail) {
  const auto store = storm_store::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc"},
                                                   {.read_ahead = 0});
  ASSERT_TRUE(store.ok()) << store.status();
  const auto fields = (*store)->Get("supercell", 1, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  const auto depths_with = [&](const Technique& technique) {
    Scene scene;
    scene.rendering.technique = technique;
    picture::LinearPicture picture;
    picture.size_px = {16, 9};
    AddOpticalDepths(scene, **fields, &picture);
    return picture.optical_depth;
  };
  const FieldLook with{.detail = true};
  const FieldLook without{.detail = false};
  EXPECT_NE(depths_with(LightVolume{.medium = {.look = with}}),
            depths_with(LightVolume{.medium = {.look = without}}));
  EXPECT_EQ(depths_with(Metaballs{.medium = {.look = with}}), depths_with(Metaballs{}));
  EXPECT_FALSE(FieldLookOf(Metaballs{.medium = {.look = with}}).detail);
}

}  // namespace
}  // namespace thunderhead::scene
