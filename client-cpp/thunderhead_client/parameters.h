// The list of every parameter of a scene, made from the descriptors of the Protobuf messages. A
// field that is added to scene.proto appears in this list without a change of code. A parameter's
// value is found by the path of fields that leads to it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "google/protobuf/descriptor.h"
#include "thunderhead/v1/scene.pb.h"
#include "thunderhead_client/limits.h"

namespace thunderhead::client {

struct Parameter {
  enum class Kind { kNumber, kFlag, kText, kChoice };
  struct Step {
    const google::protobuf::FieldDescriptor* field = nullptr;
    int index = -1;  // index of the element if the field is a list, otherwise -1
  };

  std::string path;       // such as "sun.azimuth_deg" or "fields[0].scale"
  std::string full_name;  // name in the schema, such as "thunderhead.v1.Sun.azimuth_deg"
  std::string name;       // name shown to people, without the unit
  std::string group;      // the part of the scene, such as "sun"
  Kind kind = Kind::kNumber;
  Limits limits;            // used only if kind is kNumber
  bool default_on = false;  // used only if kind is kFlag
  // Used only if kind is kChoice: enumerator numbers with their names.
  std::vector<std::pair<int, std::string>> options;
  std::vector<Step> steps;
};

// Returns the parameters that the scene has now. A oneof contributes only the case that is set, and
// a list contributes each of its elements.
std::vector<Parameter> ParametersOf(const v1::Scene& scene);

// Returns the value of a number, of a flag (0 or 1) or of a choice (the enumerator's number).
// Returns nothing if the scene has no such value.
std::optional<double> NumberIn(const v1::Scene& scene, const Parameter& parameter);
// Returns the value of a text; an empty text if the scene has no such value.
std::string TextIn(const v1::Scene& scene, const Parameter& parameter);
// Sets a number, a flag or a choice. A number is clamped to its limits.
void SetNumber(v1::Scene& scene, const Parameter& parameter, double value);
void SetText(v1::Scene& scene, const Parameter& parameter, const std::string& value);
// Clears the parameter's value in the scene, so that the server chooses a value.
void Clear(v1::Scene& scene, const Parameter& parameter);

// Returns the first sentence of a field's comment in scene.proto; an empty text if the field has no
// comment. The argument is the field's full name.
std::string_view CommentOf(std::string_view full_name);

}  // namespace thunderhead::client
