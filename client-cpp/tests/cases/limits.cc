#include "thunderhead_client/limits.h"

#include <algorithm>

#include "client-cpp/tests/cases/runners.h"
#include "thunderhead_client/parameters.h"

namespace thunderhead::client::testing {
namespace {

Limits LimitsAt(const v1::Scene& scene, const std::string& path) {
  const std::vector<Parameter> parameters = ParametersOf(scene);
  const auto found = std::ranges::find(parameters, path, &Parameter::path);
  if (found == parameters.end() || found->kind != Parameter::Kind::kNumber) {
    throw CaseError(path + " is no number of the scene");
  }
  return found->limits;
}

}  // namespace

Actions RunLimits(Arguments& given) {
  const auto scene = given.Read<v1::Scene>("scene");
  Actions actions;
  actions["limits"] = [=](Arguments& step) -> Results {
    const Limits limits = LimitsAt(scene, step.Text("path"));
    return {{"minimum", JsonOf(limits.minimum)},
            {"maximum", JsonOf(limits.maximum)},
            {"default", limits.default_value ? JsonOf(*limits.default_value) : Null()},
            {"unit", JsonOf(limits.unit)},
            {"logarithmic", JsonOf(limits.logarithmic)}};
  };
  return actions;
}

Actions RunClamp(Arguments& /*given*/) {
  Actions actions;
  actions["clamp"] = [](Arguments& step) -> Results {
    const Limits limits = LimitsAt(v1::Scene(), step.Text("path"));
    return {{"value", JsonOf(Clamp(step.Number("value"), limits))}};
  };
  return actions;
}

}  // namespace thunderhead::client::testing
