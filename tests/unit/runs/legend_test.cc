#include "runs/legend.h"

#include <set>
#include <string>

#include "gmock/gmock.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/message.h"
#include "gtest/gtest.h"

namespace thunderhead::runs {
namespace {

using ::testing::IsEmpty;
using ::testing::IsSupersetOf;

// Returns a picture of snow, which is shown, and rain, which is not.
v1::RenderImageResponse PictureOfSnow() {
  v1::RenderImageResponse picture;
  picture.mutable_modelled()->add_fields(v1::HYDROMETEOR_SNOW);
  for (const v1::Hydrometeor hydrometeor : {v1::HYDROMETEOR_RAIN, v1::HYDROMETEOR_SNOW}) {
    v1::FieldParameters& field = *picture.mutable_scene()->add_fields();
    field.set_hydrometeor(hydrometeor);
    field.mutable_false_color()->set_red(0.25F);
  }
  return picture;
}

TEST(Legend, NamesTheFieldsThatThePictureShows) {
  v1::RenderImageResponse picture = PictureOfSnow();
  picture.mutable_scene()->mutable_rendering()->mutable_light_volume()->set_false_colors(true);
  const auto legend = LegendOf(picture);
  ASSERT_EQ(legend.size(), 1U);
  EXPECT_EQ(legend[0].name, "snow");
  EXPECT_EQ(legend[0].color, glm::vec3(0.25F, 0.0F, 0.0F));
}

// A technique has a legend if and only if its settings have a field `false_colors` and it is set.
TEST(Legend, DependsOnTheFieldFalseColorsOfTheTechnique) {
  std::set<std::string> with_legend;
  const auto& techniques = *v1::Rendering::descriptor()->FindOneofByName("technique");
  for (int i = 0; i < techniques.field_count(); ++i) {
    if (techniques.field(i)->message_type() == nullptr) continue;  // a preset
    v1::RenderImageResponse picture = PictureOfSnow();
    v1::Rendering& rendering = *picture.mutable_scene()->mutable_rendering();
    auto& settings =
        *rendering.GetReflection()->MutableMessage(&rendering, techniques.field(i), nullptr);
    EXPECT_THAT(LegendOf(picture), IsEmpty()) << techniques.field(i)->name();
    const auto* const field = settings.GetDescriptor()->FindFieldByName("false_colors");
    if (field == nullptr) continue;
    settings.GetReflection()->SetBool(&settings, field, true);
    EXPECT_EQ(LegendOf(picture).size(), 1U) << techniques.field(i)->name();
    with_legend.insert(techniques.field(i)->name());
  }
  EXPECT_THAT(with_legend, IsSupersetOf({"light_volume", "half_angle", "metaball", "reference"}));
}

TEST(Legend, IsEmptyWithoutATechnique) {
  v1::RenderImageResponse picture = PictureOfSnow();
  EXPECT_THAT(LegendOf(picture), IsEmpty());
  picture.mutable_scene()->mutable_rendering()->set_preset(v1::PRESET_BALANCED);
  EXPECT_THAT(LegendOf(picture), IsEmpty());
}

}  // namespace
}  // namespace thunderhead::runs
