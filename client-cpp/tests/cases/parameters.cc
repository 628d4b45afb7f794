#include "thunderhead_client/parameters.h"

#include <algorithm>
#include <memory>

#include "client-cpp/tests/cases/runners.h"

namespace thunderhead::client::testing {
namespace {

// A scene, and the list of its parameters before the steps.
struct Listed {
  const Parameter* Find(const std::string& path) const {
    const auto found = std::ranges::find(parameters, path, &Parameter::path);
    return found == parameters.end() ? nullptr : &*found;
  }
  const Parameter& Get(const std::string& path) const {
    const Parameter* const parameter = Find(path);
    if (parameter == nullptr) throw CaseError("the scene has no parameter " + path);
    return *parameter;
  }
  Results Observed() const { return {{"scene", JsonOf(scene)}}; }

  v1::Scene scene;
  std::vector<Parameter> parameters;
};

std::string NameOf(Parameter::Kind kind) {
  switch (kind) {
    case Parameter::Kind::kNumber:
      return "number";
    case Parameter::Kind::kFlag:
      return "flag";
    case Parameter::Kind::kText:
      return "text";
    case Parameter::Kind::kChoice:
      return "choice";
  }
  return "";
}

Json Described(const Parameter* parameter) {
  if (parameter == nullptr) return Null();
  Json json;
  auto& fields = *json.mutable_struct_value()->mutable_fields();
  fields["full_name"] = JsonOf(parameter->full_name);
  fields["name"] = JsonOf(parameter->name);
  fields["group"] = JsonOf(parameter->group);
  fields["kind"] = JsonOf(NameOf(parameter->kind));
  if (parameter->kind == Parameter::Kind::kFlag) {
    fields["default_on"] = JsonOf(parameter->default_on);
  }
  if (parameter->kind == Parameter::Kind::kChoice) {
    std::vector<Json> options;
    for (const auto& [value, name] : parameter->options) {
      options.push_back(
          JsonOf(std::vector<Json>{JsonOf(static_cast<double>(value)), JsonOf(name)}));
    }
    fields["options"] = JsonOf(options);
  }
  return json;
}

void Set(v1::Scene& scene, const Parameter& parameter, const Json& value) {
  if (value.has_string_value()) return SetText(scene, parameter, value.string_value());
  const double flag = value.bool_value() ? 1.0 : 0.0;
  SetNumber(scene, parameter, value.has_bool_value() ? flag : value.number_value());
}

}  // namespace

Actions RunParameters(Arguments& given) {
  const auto listed = std::make_shared<Listed>();
  listed->scene = given.Read<v1::Scene>("scene");
  listed->parameters = ParametersOf(listed->scene);
  Actions actions;
  actions["parameter"] = [=](Arguments& step) -> Results {
    return {{"parameter", Described(listed->Find(step.Text("path")))}};
  };
  actions["set"] = [=](Arguments& step) {
    Set(listed->scene, listed->Get(step.Text("path")), step.Get("value"));
    return listed->Observed();
  };
  actions["clear"] = [=](Arguments& step) {
    Clear(listed->scene, listed->Get(step.Text("path")));
    return listed->Observed();
  };
  actions["replace"] = [=](Arguments& step) {
    listed->scene = step.Read<v1::Scene>("scene");
    return listed->Observed();
  };
  return actions;
}

}  // namespace thunderhead::client::testing
