// The defaults of a scene agree everywhere: in the options of the messages' fields, in
// scene/scene.h and in the messages that the server completes.
#include <string>

#include "absl/strings/str_cat.h"
#include "accuracy/presets.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/util/message_differencer.h"
#include "gtest/gtest.h"
#include "service/scene_messages.h"
#include "service/technique_messages.h"
#include "thunderhead/v1/limits.pb.h"

namespace thunderhead::service {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::util::MessageDifferencer;

double NumberOf(const Message& message, const FieldDescriptor& field) {
  const auto& reflection = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_FLOAT:
      return reflection.GetFloat(message, &field);
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return reflection.GetDouble(message, &field);
    case FieldDescriptor::CPPTYPE_UINT32:
      return reflection.GetUInt32(message, &field);
    default:
      ADD_FAILURE() << field.full_name() << " is a number of an unknown type";
      return 0.0;
  }
}

// Compares every number that has a default in its options; returns how many there are.
int CompareNumbers(const Message& message, const std::string& path) {
  int compared = 0;
  const google::protobuf::Descriptor& type = *message.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    const auto& reflection = *message.GetReflection();
    const std::string name = absl::StrCat(path, ".", field.name());
    if (field.is_repeated()) {
      if (field.message_type() == nullptr || field.is_map()) continue;
      for (int j = 0; j < reflection.FieldSize(message, &field); ++j) {
        compared += CompareNumbers(reflection.GetRepeatedMessage(message, &field, j), name);
      }
    } else if (field.message_type() != nullptr) {
      if (!reflection.HasField(message, &field)) continue;
      compared += CompareNumbers(reflection.GetMessage(message, &field), name);
    } else if (field.options().HasExtension(v1::number) &&
               field.options().GetExtension(v1::number).has_default_value()) {
      const double wanted = field.options().GetExtension(v1::number).default_value();
      EXPECT_FLOAT_EQ(NumberOf(message, field), wanted) << name;
      ++compared;
    }
  }
  return compared;
}

volume::StormInfo Storm() {
  volume::StormInfo storm;
  storm.id = "storm";
  storm.times.resize(1);
  storm.fields.assign(physics::kHydrometeors.begin(), physics::kHydrometeors.end());
  return storm;
}

v1::Scene Completed(v1::Scene scene = {}) {
  FillSceneDefaults(scene, Storm());
  return scene;
}

TEST(SceneDefaults, OfNumbersAreTheirOptions) {
  EXPECT_GT(CompareNumbers(Completed(), "scene"), 20);
  v1::Scene spotter;
  spotter.mutable_camera()->mutable_spotter();
  EXPECT_GT(CompareNumbers(Completed(spotter), "spotter"), 20);
  v1::Scene lights;
  lights.add_lights();
  EXPECT_GT(CompareNumbers(Completed(lights), "lights"), 20);
}

TEST(SceneDefaults, OfTechniquesAreTheirOptionsAndTheValuesOwn) {
  const google::protobuf::OneofDescriptor& techniques =
      *v1::Rendering::descriptor()->FindOneofByName("technique");
  int compared = 0;
  for (int i = 0; i < techniques.field_count(); ++i) {
    const FieldDescriptor& field = *techniques.field(i);
    if (field.message_type() == nullptr || field.name() == "other") continue;
    v1::Rendering rendering;
    rendering.GetReflection()->MutableMessage(&rendering, &field);
    FillTechniqueDefaults(rendering);
    compared += CompareNumbers(rendering, field.name());
    // Every field of it is filled in.
    const Message& filled = rendering.GetReflection()->GetMessage(rendering, &field);
    for (int j = 0; j < field.message_type()->field_count(); ++j) {
      const FieldDescriptor& setting = *field.message_type()->field(j);
      EXPECT_TRUE(filled.GetReflection()->HasField(filled, &setting)) << setting.full_name();
    }
    const scene::Technique technique = ToTechnique(rendering);
    EXPECT_EQ(scene::NameOf(technique), field.name());
    v1::Rendering again;
    ToMessage(technique, again);
    EXPECT_TRUE(MessageDifferencer::Equals(again, rendering)) << field.name();
  }
  EXPECT_GE(compared, 15);
  // Without regard to floats and doubles: these have only exact numbers.
  for (const scene::Technique& own :
       {scene::Technique(scene::LightVolume{}), scene::Technique(scene::HalfAngle{}),
        scene::Technique(scene::Reference{})}) {
    v1::Rendering rendering;
    ToMessage(own, rendering);
    EXPECT_TRUE(ToTechnique(rendering) == own);
  }
}

TEST(SceneDefaults, OfTheValueAreThoseOfTheCompletedMessage) {
  const scene::Scene value = ToScene(Completed());
  const scene::Scene own;
  EXPECT_TRUE(value.rendering.technique == own.rendering.technique);
  EXPECT_TRUE(own.rendering.technique == accuracy::TechniqueOf(accuracy::kDefaultPreset));
  EXPECT_EQ(value.time_index, own.time_index);
  const auto& camera = std::get<scene::OrbitCamera>(value.camera);
  const scene::OrbitCamera own_camera = std::get<scene::OrbitCamera>(own.camera);
  EXPECT_EQ(camera.azimuth_deg, own_camera.azimuth_deg);
  EXPECT_EQ(camera.field_of_view_deg, own_camera.field_of_view_deg);
  EXPECT_EQ(value.sun, own.sun);
  EXPECT_FLOAT_EQ(value.sky.brightness, own.sky.brightness);
  EXPECT_FLOAT_EQ(value.sky.ground_albedo, own.sky.ground_albedo);
  EXPECT_FLOAT_EQ(value.sky.turbidity, own.sky.turbidity);
  EXPECT_EQ(value.display, own.display);
  EXPECT_EQ(value.output, own.output);
  EXPECT_EQ(value.accuracy, own.accuracy);
  EXPECT_EQ(value.lights, own.lights);
  for (const physics::Hydrometeor hydrometeor : physics::kHydrometeors) {
    const std::size_t i = physics::IndexOf(hydrometeor);
    EXPECT_TRUE(value.fields[i] == own.fields[i]) << physics::NameOf(hydrometeor);
  }
}

// The sizes of cloud's particles in a scene as it is drawn.
scene::FieldParameters Cloud(const v1::Scene& scene) { return ToScene(Completed(scene)).fields[0]; }

TEST(SceneDefaults, ARadiusWinsOverTheFieldsSizesAndThoseOverTheScenes) {
  using physics::SizeSource;
  v1::Scene scene;
  EXPECT_EQ(Cloud(scene).sizes, SizeSource::kModel);
  scene.set_particle_sizes(v1::PARTICLE_SIZES_PAPERS);
  EXPECT_EQ(Cloud(scene).sizes, SizeSource::kPapers);
  v1::FieldParameters& cloud = *scene.add_fields();
  cloud.set_hydrometeor(v1::HYDROMETEOR_CLOUD);
  EXPECT_EQ(Cloud(scene).sizes, SizeSource::kPapers);
  cloud.set_sizes(v1::PARTICLE_SIZES_MODEL);
  EXPECT_EQ(Cloud(scene).sizes, SizeSource::kModel);
  cloud.set_radius_m(3e-5F);
  EXPECT_EQ(Cloud(scene).sizes, SizeSource::kGiven);
  EXPECT_EQ(Cloud(scene).optics.radius_m, 3e-5F);
  EXPECT_EQ(Completed(scene).fields(0).sizes(), v1::PARTICLE_SIZES_GIVEN);
  EXPECT_EQ(Completed(scene).fields(0).radius_m(), 3e-5F);
  cloud.clear_radius_m();
  cloud.set_sizes(v1::PARTICLE_SIZES_GIVEN);
  EXPECT_EQ(Cloud(scene).sizes, SizeSource::kGiven);
  EXPECT_EQ(Completed(scene).fields(0).radius_m(), 1e-5F);
  EXPECT_EQ(ToScene(Completed(scene)).fields[1].sizes, SizeSource::kPapers);
}

// What is filled in stays when it comes back, and gives no radius that nobody gave.
TEST(SceneDefaults, OfSizesAreFilledInOnce) {
  const v1::Scene once = Completed();
  EXPECT_EQ(once.particle_sizes(), v1::PARTICLE_SIZES_MODEL);
  for (const v1::FieldParameters& field : once.fields()) EXPECT_FALSE(field.has_radius_m());
  EXPECT_TRUE(MessageDifferencer::Equals(Completed(once), once));
}

TEST(SceneDefaults, ThePapersPresetsStandForTheirConstants) {
  const auto sizes = [](v1::Preset preset, v1::ParticleSizes given) {
    v1::Scene scene;
    scene.mutable_rendering()->set_preset(preset);
    scene.set_particle_sizes(given);
    return Completed(scene).particle_sizes();
  };
  for (const v1::Preset preset :
       {v1::PRESET_UNIFORM_PHASE_LOW_ALBEDO, v1::PRESET_UNIFORM_PHASE_TRANSLUCENT,
        v1::PRESET_PER_FIELD_PHASE_TRANSLUCENT, v1::PRESET_PER_FIELD_PHASE_DETAIL_TRANSLUCENT}) {
    EXPECT_EQ(sizes(preset, v1::PARTICLE_SIZES_UNSPECIFIED), v1::PARTICLE_SIZES_PAPERS);
    EXPECT_EQ(sizes(preset, v1::PARTICLE_SIZES_MODEL), v1::PARTICLE_SIZES_MODEL);
  }
  for (const v1::Preset preset : {v1::PRESET_FAST, v1::PRESET_BALANCED, v1::PRESET_TRUE}) {
    EXPECT_EQ(sizes(preset, v1::PARTICLE_SIZES_UNSPECIFIED), v1::PARTICLE_SIZES_MODEL);
  }
}

// The ground that is the default follows from the storm; rings are as the value has them.
TEST(SceneDefaults, TheGroundIsThatOfTheStormAndPlainInThePapersLook) {
  const auto cover = [](const volume::StormInfo& storm, v1::Scene scene = {}) {
    FillSceneDefaults(scene, storm);
    EXPECT_EQ(scene.ground().rings(), scene::Ground{}.rings);
    EXPECT_EQ(ToScene(scene).ground.rings, scene::Ground{}.rings);
    return ToScene(scene).ground.cover;
  };
  volume::StormInfo real = Storm();
  real.latitude_deg = 35.0;
  real.longitude_deg = -97.0;
  EXPECT_EQ(cover(Storm()), scene::GroundCover::kFields);
  EXPECT_EQ(cover(real), scene::GroundCover::kLandUse);
  v1::Scene papers;
  papers.mutable_rendering()->set_preset(v1::PRESET_UNIFORM_PHASE_TRANSLUCENT);
  EXPECT_EQ(cover(Storm(), papers), scene::GroundCover::kPlain);
  EXPECT_EQ(cover(real, papers), scene::GroundCover::kPlain);
  papers.mutable_ground()->set_cover(v1::Ground::COVER_FIELDS);
  EXPECT_EQ(cover(Storm(), papers), scene::GroundCover::kFields);
  v1::Scene plain;
  plain.mutable_ground()->set_cover(v1::Ground::COVER_PLAIN);
  EXPECT_EQ(cover(Storm(), plain), scene::GroundCover::kPlain);
}

TEST(SceneDefaults, APresetIsReplacedByItsTechnique) {
  for (const auto& [preset, technique] :
       {std::pair{v1::PRESET_FAST, accuracy::TechniqueOf(accuracy::Preset::kFast)},
        std::pair{v1::PRESET_TRUE, accuracy::TechniqueOf(accuracy::Preset::kTrue)},
        std::pair{v1::PRESET_UNIFORM_PHASE_LOW_ALBEDO,
                  accuracy::TechniqueOf(accuracy::Preset::kUniformPhaseLowAlbedo)}}) {
    v1::Rendering rendering;
    rendering.set_preset(preset);
    FillTechniqueDefaults(rendering);
    EXPECT_TRUE(ToTechnique(rendering) == technique) << v1::Preset_Name(preset);
  }
}

TEST(SceneDefaults, LightIsTracedByDefaultWhereItIsShown) {
  v1::Rendering rendering;
  rendering.mutable_light_volume()->set_transport(v1::TRANSPORT_PAPER);
  FillTechniqueDefaults(rendering);
  EXPECT_EQ(rendering.light_volume().traced_light(), v1::TRACED_LIGHT_OFF);
  // It cannot be shown, and the frame says so.
  rendering.mutable_light_volume()->set_traced_light(v1::TRACED_LIGHT_AT_REST);
  FillTechniqueDefaults(rendering);
  EXPECT_EQ(rendering.light_volume().traced_light(), v1::TRACED_LIGHT_AT_REST);
}

}  // namespace
}  // namespace thunderhead::service
