// Tests that the defaults of a scene agree everywhere: in the options of the messages' fields, in
// scene/scene.h and in the messages that the server completes.
#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "accuracy/presets.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/util/json_util.h"
#include "google/protobuf/util/message_differencer.h"
#include "gtest/gtest.h"
#include "service/messages/camera_messages.h"
#include "service/messages/limits_check.h"
#include "service/messages/scene_messages.h"
#include "service/messages/technique_messages.h"
#include "tests/service/scene_fields.h"
#include "thunderhead/v1/limits.pb.h"

namespace thunderhead::service {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::util::MessageDifferencer;
using testing::Completed;
using testing::FieldValues;
using testing::StormWithEveryField;

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

// Choices and switches without a fixed default. Their default depends on the storm or on other
// fields, or they have none.
const std::set<std::string> kWithoutDefault = {
    "thunderhead.v1.FieldParameters.hydrometeor",
    "thunderhead.v1.FieldParameters.sizes",
    "thunderhead.v1.Ground.borders",
    "thunderhead.v1.Ground.cover",
    "thunderhead.v1.PhaseFunction.kind",
    "thunderhead.v1.Scene.particle_sizes",
    "thunderhead.v1.Sun.source",
};

// Compares the value with the default in the field's options. Returns false for a field without a
// default.
bool CompareWithDefault(const Message& message, const FieldDescriptor& field,
                        const std::string& name) {
  const google::protobuf::FieldOptions& options = field.options();
  const auto& reflection = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      EXPECT_NE(options.HasExtension(v1::default_on), kWithoutDefault.contains(field.full_name()))
          << name;
      if (!options.HasExtension(v1::default_on)) return false;
      EXPECT_EQ(reflection.GetBool(message, &field), options.GetExtension(v1::default_on)) << name;
      return true;
    case FieldDescriptor::CPPTYPE_ENUM:
      EXPECT_NE(options.HasExtension(v1::default_choice),
                kWithoutDefault.contains(field.full_name()))
          << name;
      if (!options.HasExtension(v1::default_choice)) return false;
      EXPECT_EQ(reflection.GetEnum(message, &field)->name(),
                options.GetExtension(v1::default_choice))
          << name;
      return true;
    default:
      if (!options.GetExtension(v1::number).has_default_value()) return false;
      EXPECT_FLOAT_EQ(NumberOf(message, field), options.GetExtension(v1::number).default_value())
          << name;
      return true;
  }
}

// Compares every value that has a default in its options, and returns their number. `message` holds
// defaults.
int CompareDefaults(const Message& message, const std::string& path) {
  int compared = 0;
  const google::protobuf::Descriptor& type = *message.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    const auto& reflection = *message.GetReflection();
    const std::string name = absl::StrCat(path, ".", field.name());
    // For a oneof, only the chosen field is compared.
    if (field.real_containing_oneof() != nullptr && !reflection.HasField(message, &field)) continue;
    if (field.is_repeated()) {
      if (field.message_type() == nullptr || field.is_map()) continue;
      for (int j = 0; j < reflection.FieldSize(message, &field); ++j) {
        compared += CompareDefaults(reflection.GetRepeatedMessage(message, &field, j), name);
      }
    } else if (field.message_type() != nullptr) {
      if (!reflection.HasField(message, &field)) continue;
      compared += CompareDefaults(reflection.GetMessage(message, &field), name);
    } else {
      compared += CompareWithDefault(message, field, name) ? 1 : 0;
    }
  }
  return compared;
}

// Returns the value rounded to single precision, as a message stores it.
scene::Scene InSinglePrecision(scene::Scene value) {
  v1::Camera camera;
  ToMessage(value.camera, camera);
  value.camera = ToCamera(camera);
  v1::Rendering rendering;
  ToMessage(value.rendering.technique, rendering);
  value.rendering.technique = ToTechnique(rendering);
  for (double* number : {&value.sky.brightness, &value.sky.ground_albedo, &value.sky.turbidity}) {
    // The variable is volatile because GCC 12 otherwise omits rounding neighbouring doubles to
    // floats and back.
    const volatile auto single = static_cast<float>(*number);
    *number = single;
  }
  return value;
}

// Clears the numbers in `message` whose field options contain a default.
void ClearNumbersWithDefaults(Message& message) {
  std::vector<const FieldDescriptor*> set;
  message.GetReflection()->ListFields(message, &set);
  for (const FieldDescriptor* field : set) {
    if (field->message_type() != nullptr) {
      ClearNumbersWithDefaults(*message.GetReflection()->MutableMessage(&message, field));
    } else if (field->options().GetExtension(v1::number).has_default_value()) {
      message.GetReflection()->ClearField(&message, field);
    }
  }
}

// The same default scene in two forms: a message that the server has completed, and a scene::Scene
// that is built separately. Defaults that depend on the storm are copied from the scene::Scene into
// the message.
struct Defaults {
  v1::Scene message;
  scene::Scene value;
};

template <typename Camera, typename Technique>
Defaults DefaultsWith(const Camera& camera, const Technique& technique) {
  Defaults defaults;
  defaults.value.camera = camera;
  defaults.value.rendering.technique = technique;
  defaults.value.lights.resize(1);
  ToMessage(defaults.value.camera, *defaults.message.mutable_camera());
  ClearNumbersWithDefaults(*defaults.message.mutable_camera());
  v1::Rendering& rendering = *defaults.message.mutable_rendering();
  ToMessage(defaults.value.rendering.technique, rendering);
  const FieldDescriptor* field = rendering.GetReflection()->GetOneofFieldDescriptor(
      rendering, rendering.GetDescriptor()->FindOneofByName("technique"));
  rendering.GetReflection()->MutableMessage(&rendering, field)->Clear();
  defaults.message.add_lights();
  defaults.message = Completed(defaults.message);
  const scene::Scene completed = ToScene(defaults.message);
  defaults.value.storm_id = completed.storm_id;
  defaults.value.ground.cover = completed.ground.cover;
  defaults.value = InSinglePrecision(defaults.value);
  return defaults;
}

// Returns each alternative of the variant, with its defaults.
template <typename Variant, std::size_t... i>
std::vector<Variant> AllOf(std::index_sequence<i...> /*indices*/) {
  return {Variant(std::variant_alternative_t<i, Variant>{})...};
}

template <typename Variant>
std::vector<Variant> AllOf() {
  return AllOf<Variant>(std::make_index_sequence<std::variant_size_v<Variant>>());
}

// Returns the defaults for each kind of camera and each technique with its own message.
std::vector<Defaults> AllDefaults() {
  std::vector<Defaults> all;
  for (const scene::Camera& camera : AllOf<scene::Camera>()) {
    all.push_back(DefaultsWith(camera, scene::Technique()));
  }
  for (const scene::Technique& technique : AllOf<scene::Technique>()) {
    if (std::holds_alternative<scene::OtherTechnique>(technique)) continue;
    all.push_back(DefaultsWith(scene::Camera(), technique));
  }
  return all;
}

// The comparison of whole scenes covers all fields. The parts are compared first, so that a failure
// shows which part differs.
TEST(SceneDefaults, OfTheValueAreThoseOfTheCompletedMessage) {
  for (const Defaults& defaults : AllDefaults()) {
    const scene::Scene value = ToScene(defaults.message);
    const scene::Scene& own = defaults.value;
    SCOPED_TRACE(defaults.message.camera().ShortDebugString() + " " +
                 defaults.message.rendering().ShortDebugString());
    EXPECT_TRUE(value.camera == own.camera);
    EXPECT_TRUE(value.rendering == own.rendering);
    EXPECT_TRUE(value.sun == own.sun);
    EXPECT_TRUE(value.sky == own.sky);
    EXPECT_TRUE(value.ground == own.ground);
    EXPECT_TRUE(value.display == own.display);
    EXPECT_TRUE(value.output == own.output);
    EXPECT_TRUE(value.lights == own.lights);
    for (const physics::Hydrometeor hydrometeor : physics::kHydrometeors) {
      const std::size_t i = physics::IndexOf(hydrometeor);
      EXPECT_TRUE(value.fields[i] == own.fields[i]) << physics::NameOf(hydrometeor);
    }
    EXPECT_TRUE(value == own);
  }
}

TEST(SceneDefaults, OfAnEmptySceneAreThoseOfTheValue) {
  const v1::Scene completed = Completed();
  const scene::Scene value = ToScene(completed);
  EXPECT_TRUE(value.rendering.technique == scene::Scene().rendering.technique);
  EXPECT_TRUE(value.rendering.technique == accuracy::TechniqueOf(accuracy::kDefaultPreset));
  EXPECT_TRUE(std::holds_alternative<scene::OrbitCamera>(value.camera));
  EXPECT_EQ(value.lights.size(), 0U);
  EXPECT_EQ(completed.fields_size(), static_cast<int>(physics::kHydrometeorCount));
  EXPECT_GE(CompareDefaults(completed, "scene"), 50);
}

// Fields that completing a message replaces by others, so that they do not reach the value.
const std::set<std::string> kReplaced = {
    "thunderhead.v1.Sun.source",
    "thunderhead.v1.SunClock.date_time",
    "thunderhead.v1.SunClock.latitude_deg",
    "thunderhead.v1.SunClock.longitude_deg",
    // Chooses the field of the value. A repeated hydrometeor would be refused.
    "thunderhead.v1.FieldParameters.hydrometeor",
};

// Returns true if each value of the field results in a different scene.
bool Matters(const FieldValues& values) {
  for (auto at = values.scenes.begin(); at != values.scenes.end(); ++at) {
    if (std::find(values.scenes.begin(), at, *at) != at) return false;
  }
  return values.scenes.size() > 1;
}

// Every field of the message reaches the value, whose defaults are compared above.
TEST(SceneDefaults, EveryFieldOfTheMessageReachesTheValue) {
  std::set<std::string> checked;
  for (const v1::Scene& scene : testing::ScenesWithEveryField()) {
    testing::VisitFields(scene, [&](const FieldValues& values) {
      EXPECT_NE(Matters(values), kReplaced.contains(values.field.full_name())) << values.path;
      checked.insert(values.field.full_name());
    });
  }
  EXPECT_GT(checked.size(), 80U);
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
    compared += CompareDefaults(rendering, field.name());
    // Every field of the technique's message is filled in.
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
  // Float and double defaults need no rounding here, because these messages contain only exact
  // numbers.
  for (const scene::Technique& own :
       {scene::Technique(scene::LightVolume{}), scene::Technique(scene::HalfAngle{}),
        scene::Technique(scene::Reference{})}) {
    v1::Rendering rendering;
    ToMessage(own, rendering);
    EXPECT_TRUE(ToTechnique(rendering) == own);
  }
}

// The message's enumerators have the order and the names of the value's kinds.
TEST(SceneDefaults, HydrometeorsAreNamedAlike) {
  EXPECT_EQ(v1::Hydrometeor_descriptor()->value_count(),
            static_cast<int>(physics::kHydrometeorCount) + 1);
  for (const physics::Hydrometeor hydrometeor : physics::kHydrometeors) {
    EXPECT_EQ(v1::Hydrometeor_Name(ToMessage(hydrometeor)),
              absl::StrCat("HYDROMETEOR_",
                           absl::AsciiStrToUpper(std::string(physics::NameOf(hydrometeor)))));
  }
}

// Records and clients identify the kinds by these numbers.
TEST(SceneDefaults, PhaseKindsAreNamedAlike) {
  using physics::PhaseKind;
  const std::vector<std::pair<std::string, PhaseKind>> kinds = {
      {"KIND_HENYEY_GREENSTEIN", PhaseKind::kHenyeyGreenstein},
      {"KIND_CORNETTE_SHANKS", PhaseKind::kCornetteShanks},
      {"KIND_RAYLEIGH", PhaseKind::kRayleigh},
      {"KIND_WATER_DROPLETS", PhaseKind::kWaterDroplets},
      {"KIND_ICE_COLUMNS", PhaseKind::kIceColumns},
      {"KIND_ICE_PLATES", PhaseKind::kIcePlates},
      {"KIND_ICE_ROUGH", PhaseKind::kIceRough},
      {"KIND_WATER_NARROW", PhaseKind::kWaterNarrow}};
  ASSERT_EQ(v1::PhaseFunction::Kind_descriptor()->value_count(),
            static_cast<int>(kinds.size()) + 1);
  for (const auto& [name, kind] : kinds) {
    v1::Scene scene;
    v1::FieldParameters& cloud = *scene.add_fields();
    cloud.set_hydrometeor(v1::HYDROMETEOR_CLOUD);
    v1::PhaseFunction::Kind message;
    ASSERT_TRUE(v1::PhaseFunction::Kind_Parse(name, &message)) << name;
    cloud.mutable_phase()->set_kind(message);
    EXPECT_EQ(ToScene(Completed(scene)).fields[0].optics.phase.kind, kind) << name;
  }
}

// A damaged record of a session may contain such a field.
TEST(SceneDefaults, AFieldWithoutAPhaseKindHasTheFirst) {
  v1::Scene scene;
  scene.add_fields()->set_hydrometeor(v1::HYDROMETEOR_CLOUD);
  EXPECT_EQ(ToScene(scene).fields[0].optics.phase.kind, physics::PhaseKind::kHenyeyGreenstein);
}

// Returns the sizes of cloud particles in a scene as it is drawn.
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

// Completing a completed scene changes nothing, and adds no radius that was not given.
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
  for (const v1::Preset preset : {v1::PRESET_FAST, v1::PRESET_BALANCED, v1::PRESET_ACCURATE}) {
    EXPECT_EQ(sizes(preset, v1::PARTICLE_SIZES_UNSPECIFIED), v1::PARTICLE_SIZES_MODEL);
  }
}

// By default borders are drawn if the ground is coloured by land use and the storm has a map
// projection.
TEST(SceneDefaults, BordersAreOnWhereTheGroundIsThatOfARealPlace) {
  const auto borders = [](const storm_store::StormInfo& storm, v1::Scene scene = {}) {
    FillSceneDefaults(scene, storm);
    EXPECT_TRUE(scene.ground().has_borders());
    EXPECT_EQ(ToScene(scene).ground.borders, scene.ground().borders());
    return scene.ground().borders();
  };
  storm_store::StormInfo real = StormWithEveryField();
  real.latitude_deg = 35.0;
  real.longitude_deg = -97.0;
  EXPECT_FALSE(borders(StormWithEveryField()));
  EXPECT_FALSE(borders(real)) << "its projection is not known";
  real.projection = "+proj=merc +lat_ts=15 +lon_0=120 +R=6370000";
  EXPECT_TRUE(borders(real));
  v1::Scene papers;
  papers.mutable_rendering()->set_preset(v1::PRESET_UNIFORM_PHASE_TRANSLUCENT);
  EXPECT_FALSE(borders(real, papers));
  papers.mutable_ground()->set_borders(true);
  EXPECT_TRUE(borders(real, papers));
  v1::Scene off;
  off.mutable_ground()->set_borders(false);
  EXPECT_FALSE(borders(real, off));
}

// The default ground depends on the storm. The default of the rings is that of scene::Scene.
TEST(SceneDefaults, TheGroundIsThatOfTheStormAndPlainInThePapersLook) {
  const auto cover = [](const storm_store::StormInfo& storm, v1::Scene scene = {}) {
    FillSceneDefaults(scene, storm);
    EXPECT_EQ(scene.ground().rings(), scene::Ground{}.rings);
    EXPECT_EQ(ToScene(scene).ground.rings, scene::Ground{}.rings);
    return ToScene(scene).ground.cover;
  };
  storm_store::StormInfo real = StormWithEveryField();
  real.latitude_deg = 35.0;
  real.longitude_deg = -97.0;
  EXPECT_EQ(cover(StormWithEveryField()), scene::GroundCover::kFields);
  EXPECT_EQ(cover(real), scene::GroundCover::kLandUse);
  v1::Scene papers;
  papers.mutable_rendering()->set_preset(v1::PRESET_UNIFORM_PHASE_TRANSLUCENT);
  EXPECT_EQ(cover(StormWithEveryField(), papers), scene::GroundCover::kPlain);
  EXPECT_EQ(cover(real, papers), scene::GroundCover::kPlain);
  papers.mutable_ground()->set_cover(v1::Ground::COVER_FIELDS);
  EXPECT_EQ(cover(StormWithEveryField(), papers), scene::GroundCover::kFields);
  v1::Scene plain;
  plain.mutable_ground()->set_cover(v1::Ground::COVER_PLAIN);
  EXPECT_EQ(cover(StormWithEveryField(), plain), scene::GroundCover::kPlain);
}

TEST(SceneDefaults, APresetIsReplacedByItsTechnique) {
  for (const auto& [preset, technique] :
       {std::pair{v1::PRESET_FAST, accuracy::TechniqueOf(accuracy::Preset::kFast)},
        std::pair{v1::PRESET_ACCURATE, accuracy::TechniqueOf(accuracy::Preset::kAccurate)},
        std::pair{v1::PRESET_UNIFORM_PHASE_LOW_ALBEDO,
                  accuracy::TechniqueOf(accuracy::Preset::kUniformPhaseLowAlbedo)}}) {
    v1::Rendering rendering;
    rendering.set_preset(preset);
    FillTechniqueDefaults(rendering);
    EXPECT_TRUE(ToTechnique(rendering) == technique) << v1::Preset_Name(preset);
  }
}

TEST(SceneDefaults, TheEarlierNameOfPresetAccurateIsReadAndTheNewOneIsWritten) {
  v1::Scene scene;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(
                  R"({"rendering": {"preset": "PRESET_TRUE"}})", &scene)
                  .ok());
  EXPECT_EQ(scene.rendering().preset(), v1::PRESET_ACCURATE);
  std::string json;
  ASSERT_TRUE(google::protobuf::util::MessageToJsonString(scene, &json).ok());
  EXPECT_EQ(json, R"({"rendering":{"preset":"PRESET_ACCURATE"}})");
}

TEST(SceneDefaults, LightIsTracedByDefaultWhereItIsShown) {
  v1::Rendering rendering;
  rendering.mutable_light_volume()->set_transport(v1::TRANSPORT_PAPER);
  FillTechniqueDefaults(rendering);
  EXPECT_EQ(rendering.light_volume().traced_light(), v1::TRACED_LIGHT_OFF);
  // This technique cannot show the path-traced correction, and the frame reports that.
  rendering.mutable_light_volume()->set_traced_light(v1::TRACED_LIGHT_AT_REST);
  FillTechniqueDefaults(rendering);
  EXPECT_EQ(rendering.light_volume().traced_light(), v1::TRACED_LIGHT_AT_REST);
}

}  // namespace
}  // namespace thunderhead::service
