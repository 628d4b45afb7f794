#include "tests/service/scene_fields.h"

#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "google/protobuf/message.h"
#include "gtest/gtest.h"
#include "service/messages/scene_messages.h"
#include "thunderhead/v1/limits.pb.h"

namespace thunderhead::testing {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::OneofDescriptor;

void SetNumber(Message& message, const FieldDescriptor& field, double value) {
  const auto& reflection = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_FLOAT:
      return reflection.SetFloat(&message, &field, static_cast<float>(value));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return reflection.SetDouble(&message, &field, value);
    case FieldDescriptor::CPPTYPE_UINT32:
      return reflection.SetUInt32(&message, &field, static_cast<std::uint32_t>(value));
    default:
      ADD_FAILURE() << field.full_name() << " is of an unknown type";
  }
}

// Sets the field to its `i`th value. Returns false if there are no further values.
bool SetValue(Message& message, const FieldDescriptor& field, int i) {
  const auto& reflection = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      reflection.SetBool(&message, &field, i == 1);
      return i < 2;
    case FieldDescriptor::CPPTYPE_STRING:
      reflection.SetString(&message, &field, i == 0 ? "one" : "other");
      return i < 2;
    case FieldDescriptor::CPPTYPE_ENUM:
      if (i + 1 >= field.enum_type()->value_count()) return false;
      reflection.SetEnum(&message, &field, field.enum_type()->value(i + 1));
      return true;
    default:
      break;
  }
  const v1::NumberLimits& limits = field.options().GetExtension(v1::number);
  SetNumber(message, field, i == 0 ? limits.minimum() : limits.maximum());
  return i < 2;
}

// Replaces the map's entries by one number, whose name is "one". Returns false if there are no
// further values.
bool SetMap(Message& message, const FieldDescriptor& field, int i) {
  message.GetReflection()->ClearField(&message, &field);
  Message& entry = *message.GetReflection()->AddMessage(&message, &field);
  SetValue(entry, *field.message_type()->map_key(), 0);
  SetNumber(entry, *field.message_type()->map_value(), i);
  return i < 2;
}

// Returns the scene for each value of `field` of `message`, which is part of `scene`.
std::vector<scene::Scene> ScenesOf(const v1::Scene& scene, Message& message,
                                   const FieldDescriptor& field) {
  const std::unique_ptr<Message> kept(message.New());
  kept->CopyFrom(message);
  std::vector<scene::Scene> scenes;
  const auto set = [&](int i) {
    return field.is_map() ? SetMap(message, field, i) : SetValue(message, field, i);
  };
  for (int i = 0; set(i); ++i) {
    scenes.push_back(service::ToScene(scene));
    message.CopyFrom(*kept);
  }
  message.CopyFrom(*kept);
  return scenes;
}

void VisitFieldsOf(const v1::Scene& scene, Message& message, const std::string& path,
                   const std::function<void(const FieldValues&)>& visit) {
  const auto& reflection = *message.GetReflection();
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor& field = *message.GetDescriptor()->field(i);
    const std::string name = absl::StrCat(path, ".", field.name());
    if (field.real_containing_oneof() != nullptr && !reflection.HasField(message, &field)) continue;
    if (field.message_type() == nullptr || field.is_map()) {
      visit({field, name, ScenesOf(scene, message, field)});
    } else if (!field.is_repeated()) {
      VisitFieldsOf(scene, *reflection.MutableMessage(&message, &field), name, visit);
    } else if (reflection.FieldSize(message, &field) > 0) {
      VisitFieldsOf(scene, *reflection.MutableRepeatedMessage(&message, &field, 0), name, visit);
    } else {
      ADD_FAILURE() << name << " has no entry; add one in ScenesWithEveryField()";
    }
  }
}

v1::Scene WithEveryRepeatedField(v1::Scene scene) {
  scene.add_lights();
  return Completed(std::move(scene));
}

// Adds a scene for each member of the oneof `name` in the part of a scene that `part` returns.
template <typename Part>
void AddMembers(const std::string& name, const Part& part, std::vector<v1::Scene>& scenes) {
  v1::Scene empty;
  const OneofDescriptor& members = *part(empty)->GetDescriptor()->FindOneofByName(name);
  for (int i = 0; i < members.field_count(); ++i) {
    const FieldDescriptor& member = *members.field(i);
    v1::Scene scene;
    Message& message = *part(scene);
    if (member.message_type() != nullptr) {
      message.GetReflection()->MutableMessage(&message, &member);
    } else if (member.enum_type() == nullptr) {  // the server replaces a preset by a technique
      SetValue(message, member, 1);
    }
    scenes.push_back(WithEveryRepeatedField(std::move(scene)));
  }
}

}  // namespace

storm_store::StormInfo StormWithEveryField() {
  storm_store::StormInfo storm;
  storm.id = "storm";
  storm.times.resize(1);
  storm.fields.assign(physics::kHydrometeors.begin(), physics::kHydrometeors.end());
  return storm;
}

v1::Scene Completed(v1::Scene scene) {
  service::FillSceneDefaults(scene, StormWithEveryField());
  return scene;
}

std::vector<v1::Scene> ScenesWithEveryField() {
  std::vector<v1::Scene> scenes;
  AddMembers(
      "kind", [](v1::Scene& scene) -> Message* { return scene.mutable_camera(); }, scenes);
  AddMembers(
      "technique", [](v1::Scene& scene) -> Message* { return scene.mutable_rendering(); }, scenes);
  AddMembers(
      "limit", [](v1::Scene& scene) -> Message* { return scene.mutable_accuracy(); }, scenes);
  return scenes;
}

void VisitFields(v1::Scene scene, const std::function<void(const FieldValues&)>& visit) {
  VisitFieldsOf(scene, scene, "scene", visit);
}

}  // namespace thunderhead::testing
