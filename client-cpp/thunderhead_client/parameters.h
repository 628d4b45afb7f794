// Every parameter of a scene, read from the messages' descriptors. A field that is added to
// scene.proto appears in this list without a change of code. Values are read and changed by their
// path of fields.
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
    int index = -1;  // in a list
  };

  std::string path;       // such as "sun.azimuth_deg" or "fields[0].scale"
  std::string full_name;  // name in the schema, such as "thunderhead.v1.Sun.azimuth_deg"
  std::string name;       // name for people, without its unit
  std::string group;      // the part of the scene, such as "sun"
  Kind kind = Kind::kNumber;
  Limits limits;                                     // for a number
  bool default_on = false;                           // for a flag
  std::vector<std::pair<int, std::string>> options;  // for a choice: numbers and names
  std::vector<Step> steps;
};

// Returns the parameters that the scene has now. They include only the set case of a oneof, and
// each element of a list.
std::vector<Parameter> ParametersOf(const v1::Scene& scene);

// Returns the value of a number, a flag (0 or 1) or a choice; nothing if it is absent.
std::optional<double> NumberIn(const v1::Scene& scene, const Parameter& parameter);
// Returns the value of a text; empty if it is absent.
std::string TextIn(const v1::Scene& scene, const Parameter& parameter);
// Sets a number, a flag or a choice. A number is clamped to its limits.
void SetNumber(v1::Scene& scene, const Parameter& parameter, double value);
void SetText(v1::Scene& scene, const Parameter& parameter, const std::string& value);
// Clears the value, so that the server chooses it.
void Clear(v1::Scene& scene, const Parameter& parameter);

// Returns the first sentence of the comment of a scene.proto field; empty if there is none. The
// argument is the field's full name.
std::string_view CommentOf(std::string_view full_name);

}  // namespace thunderhead::client
