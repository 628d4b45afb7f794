// Visits every field of a scene message. For each field, the visitor gets a list of scenes that
// differ only in the value of this field. The functions are for tests that must hold for each
// field, including fields that are added later.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "google/protobuf/descriptor.h"
#include "scene/scene.h"
#include "storm_store/storm_store.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::testing {

// Returns a storm that has every hydrometeor.
storm_store::StormInfo StormWithEveryField();

// Returns the scene with the defaults that the server fills in for that storm.
v1::Scene Completed(v1::Scene scene = {});

// Returns completed scenes that together have every field of the message. There is one for each
// member of each oneof: the cameras, the techniques and the limits of accuracy.
std::vector<v1::Scene> ScenesWithEveryField();

// A field without parts, and the scene for each of its values. A number takes both of its limits,
// and an enumeration takes each enumerator except 0, which stands for the default.
struct FieldValues {
  const google::protobuf::FieldDescriptor& field;
  std::string path;  // such as "scene.lights.color.red"
  std::vector<scene::Scene> scenes;
};

// Calls `visit` for each field of the completed scene and of its parts. Of repeated parts, only the
// first is visited. Fields of a oneof that are not set are left out.
void VisitFields(v1::Scene scene, const std::function<void(const FieldValues&)>& visit);

}  // namespace thunderhead::testing
