// Every parameter of a scene, read from the messages' descriptors: a field that is added to
// scene.proto is in this list without a line of code. Values are read and changed by their path
// of fields.
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
  std::string full_name;  // in the schema, such as "thunderhead.v1.Sun.azimuth_deg"
  std::string name;       // in words, without its unit
  std::string group;      // the part of the scene, such as "sun"
  Kind kind = Kind::kNumber;
  Limits limits;                                     // of a number
  bool default_on = false;                           // of a flag
  std::vector<std::pair<int, std::string>> options;  // of a choice: numbers and names
  std::vector<Step> steps;
};

// The parameters that the scene has now: of a oneof only the case that is set, of a list its
// elements.
std::vector<Parameter> ParametersOf(const v1::Scene& scene);

// The value of a number, a flag (0 or 1) or a choice; nothing if it is absent.
std::optional<double> NumberIn(const v1::Scene& scene, const Parameter& parameter);
// The value of a text; empty if it is absent.
std::string TextIn(const v1::Scene& scene, const Parameter& parameter);
// A number is clamped to its limits.
void SetNumber(v1::Scene& scene, const Parameter& parameter, double value);
void SetText(v1::Scene& scene, const Parameter& parameter, const std::string& value);
// Clears the value, so that the server chooses it.
void Clear(v1::Scene& scene, const Parameter& parameter);

// The comment of a field of scene.proto by its full name; empty if there is none. Its first
// sentence alone.
std::string_view CommentOf(std::string_view full_name);

}  // namespace thunderhead::client
