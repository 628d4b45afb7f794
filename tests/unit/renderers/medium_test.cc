// Tests of the choice which fields a technique draws together. They need no OpenGL.
#include "renderers/medium.h"

#include "gtest/gtest.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

constexpr auto kWithDetail = test_support::kWithDetail;

volume::HydrometeorFields FieldsOf(const std::vector<physics::Hydrometeor>& hydrometeors) {
  volume::HydrometeorFields fields;
  fields.grid = {glm::ivec3(1), glm::dvec3(500.0, 400.0, 100.0), glm::dvec3(0.0)};
  for (const physics::Hydrometeor hydrometeor : hydrometeors) {
    volume::HydrometeorField field;
    field.hydrometeor = hydrometeor;
    field.concentration_kg_per_m3 = {1.0F};
    fields.fields.push_back(field);
  }
  return fields;
}

class MediumGroups : public testing::Test {
 protected:
  scene::FieldParameters& Of(physics::Hydrometeor hydrometeor) {
    return scene_.fields[physics::IndexOf(hydrometeor)];
  }
  std::size_t Groups(const accuracy::Mode& mode) {
    test_support::SetMode(&scene_.rendering.technique, mode);
    return scene::GroupedFieldsOf(scene_, fields_).groups.size();
  }

  scene::Scene scene_ = test_support::PlainScene();
  volume::HydrometeorFields fields_ =
      FieldsOf({physics::Hydrometeor::kSnow, physics::Hydrometeor::kGraupel});
};

TEST_F(MediumGroups, FieldsWithOneLookShareAGroup) {
  EXPECT_EQ(Groups(test_support::kPerFieldPhase), 1U);
  Of(physics::Hydrometeor::kSnow).optics.albedo = 0.5F;
  EXPECT_EQ(Groups(test_support::kPerFieldPhase), 2U);
}

TEST_F(MediumGroups, DetailPartsThemOnlyWhereItIsDrawn) {
  Of(physics::Hydrometeor::kSnow).detail = {.share = 0.2F};
  Of(physics::Hydrometeor::kGraupel).detail = {.share = 0.4F};
  EXPECT_EQ(Groups(test_support::kPerFieldPhase), 1U);
  EXPECT_EQ(Groups(kWithDetail), 2U);
  Of(physics::Hydrometeor::kSnow).detail.share = 0.4F;
  EXPECT_EQ(Groups(kWithDetail), 1U);
  Of(physics::Hydrometeor::kSnow).detail.seed = 2;
  EXPECT_EQ(Groups(kWithDetail), 2U);
}

TEST_F(MediumGroups, ADetailOfNoShareIsNone) {
  Of(physics::Hydrometeor::kSnow).detail = {.share = 0.0F, .seed = 3};
  Of(physics::Hydrometeor::kGraupel).detail = {.share = 0.0F, .wavelength_m = 9.0F};
  EXPECT_EQ(Groups(kWithDetail), 1U);
}

TEST_F(MediumGroups, WavelengthComesFromTheGridIfNotGiven) {
  test_support::SetMode(&scene_.rendering.technique, kWithDetail);
  EXPECT_EQ(scene::GroupedFieldsOf(scene_, fields_).groups.front().detail.wavelength_m, 1500.0F);
  Of(physics::Hydrometeor::kSnow).detail.wavelength_m = 70.0F;
  EXPECT_EQ(scene::GroupedFieldsOf(scene_, fields_).groups.front().detail.wavelength_m, 70.0F);
}

}  // namespace
}  // namespace thunderhead::renderers
