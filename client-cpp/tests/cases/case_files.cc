#include "client-cpp/tests/cases/case_files.h"

#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "absl/strings/str_cat.h"

namespace thunderhead::client::testing {
namespace {

using google::protobuf::Struct;
using google::protobuf::util::JsonStringToMessage;

// The tolerated difference of two numbers, as a fraction of the expected number. Below 1 it is
// absolute. Messages store 32-bit floats, so results are not exact.
constexpr double kTolerance = 1e-5;

std::string TextOf(const google::protobuf::Message& message) {
  std::string text;
  const auto status = google::protobuf::util::MessageToJsonString(message, &text);
  if (!status.ok()) throw CaseError(status.ToString());
  return text;
}

void Parse(const std::string& text, google::protobuf::Message& message) {
  const auto status = JsonStringToMessage(text, &message);
  if (!status.ok()) throw CaseError(status.ToString());
}

// Returns where two values differ; an empty text if they are equal.
std::string Difference(const Json& expected, const Json& found, const std::string& path);

std::string Difference(const Struct& expected, const Struct& found, const std::string& path) {
  for (const auto& [key, value] : found.fields()) {
    if (!expected.fields().contains(key)) {
      return absl::StrCat(path, ".", key, " is ", TextOf(value), " in place of nothing");
    }
  }
  for (const auto& [key, value] : expected.fields()) {
    const auto other = found.fields().find(key);
    if (other == found.fields().end()) return absl::StrCat(path, ".", key, " is missing");
    std::string difference = Difference(value, other->second, absl::StrCat(path, ".", key));
    if (!difference.empty()) return difference;
  }
  return "";
}

std::string Difference(const Json& expected, const Json& found, const std::string& path) {
  std::string differs =
      absl::StrCat(path, " is ", TextOf(found), " in place of ", TextOf(expected));
  if (expected.kind_case() != found.kind_case()) return differs;
  switch (expected.kind_case()) {
    case Json::kNumberValue: {
      const double room = kTolerance * std::max(1.0, std::abs(expected.number_value()));
      return std::abs(expected.number_value() - found.number_value()) <= room ? "" : differs;
    }
    case Json::kStructValue:
      return Difference(expected.struct_value(), found.struct_value(), path);
    case Json::kListValue: {
      const auto& values = expected.list_value().values();
      const auto& others = found.list_value().values();
      if (values.size() != others.size()) return differs;
      for (int i = 0; i < values.size(); ++i) {
        std::string difference = Difference(values[i], others[i], absl::StrCat(path, ".", i));
        if (!difference.empty()) return difference;
      }
      return "";
    }
    default:
      return TextOf(expected) == TextOf(found) ? "" : differs;
  }
}

Results Do(const Actions& actions, const Struct& step) {
  Struct values = step;
  for (const char* const key : {"do", "times", "expect"}) values.mutable_fields()->erase(key);
  const auto& fields = step.fields();
  const std::string name = fields.contains("do") ? fields.at("do").string_value() : "";
  const auto action = actions.find(name);
  if (action == actions.end()) {
    throw CaseError(absl::StrCat("the runner does not know the action '", name, "'"));
  }
  const double times = fields.contains("times") ? fields.at("times").number_value() : 1.0;
  Results results;
  for (int i = 0; i < static_cast<int>(times); ++i) {
    Arguments arguments(values);
    results = action->second(arguments);
    arguments.ExpectAllRead();
  }
  return results;
}

void RunStep(const Actions& actions, const Struct& step) {
  const Results results = Do(actions, step);
  if (!step.fields().contains("expect")) return;
  for (const auto& [key, expected] : step.fields().at("expect").struct_value().fields()) {
    const auto found = results.find(key);
    if (found == results.end()) {
      throw CaseError(absl::StrCat("the runner does not know the result '", key, "'"));
    }
    const std::string difference = Difference(expected, found->second, key);
    if (!difference.empty()) throw CaseError(difference);
  }
}

Case CaseOf(const std::string& file, const Struct& written) {
  Case each;
  each.file = file;
  const auto& fields = written.fields();
  each.name = fields.at("name").string_value();
  if (fields.contains("given")) each.given = fields.at("given").struct_value();
  for (const Json& step : fields.at("steps").list_value().values()) {
    each.steps.push_back(step.struct_value());
  }
  return each;
}

}  // namespace

const Json* Arguments::Find(const std::string& name) {
  read_.insert(name);
  const auto found = values_.fields().find(name);
  return found == values_.fields().end() ? nullptr : &found->second;
}

const Json& Arguments::Get(const std::string& name) {
  const Json* const value = Find(name);
  if (value == nullptr) throw CaseError(absl::StrCat("the argument '", name, "' is missing"));
  return *value;
}

double Arguments::Number(const std::string& name, std::optional<double> otherwise) {
  if (Find(name) == nullptr && otherwise) return *otherwise;
  if (!Get(name).has_number_value()) {
    throw CaseError(absl::StrCat("the argument '", name, "' is no number"));
  }
  return Get(name).number_value();
}

std::string Arguments::Text(const std::string& name) {
  if (!Get(name).has_string_value()) {
    throw CaseError(absl::StrCat("the argument '", name, "' is no text"));
  }
  return Get(name).string_value();
}

bool Arguments::Flag(const std::string& name, std::optional<bool> otherwise) {
  if (Find(name) == nullptr && otherwise) return *otherwise;
  if (!Get(name).has_bool_value()) {
    throw CaseError(absl::StrCat("the argument '", name, "' is neither true nor false"));
  }
  return Get(name).bool_value();
}

std::vector<double> Arguments::Numbers(const std::string& name) { return NumbersOf(Get(name)); }

void Arguments::Read(const std::string& name, google::protobuf::Message& message) {
  Parse(TextOf(Get(name)), message);
}

void Arguments::ExpectAllRead() const {
  for (const auto& [name, value] : values_.fields()) {
    if (!read_.contains(name)) throw CaseError(absl::StrCat("the runner does not know: ", name));
  }
}

std::vector<double> NumbersOf(const Json& list) {
  std::vector<double> numbers;
  for (const Json& each : list.list_value().values()) {
    if (!each.has_number_value()) throw CaseError("a list has a value that is no number");
    numbers.push_back(each.number_value());
  }
  return numbers;
}

Json JsonOf(double number) {
  Json json;
  json.set_number_value(number);
  return json;
}

Json JsonOf(bool flag) {
  Json json;
  json.set_bool_value(flag);
  return json;
}

Json JsonOf(const std::string& text) {
  Json json;
  json.set_string_value(text);
  return json;
}

Json JsonOf(const google::protobuf::Message& message) {
  Json json;
  Parse(TextOf(message), json);
  return json;
}

Json JsonOf(const std::vector<Json>& list) {
  Json json;
  json.mutable_list_value();
  for (const Json& each : list) *json.mutable_list_value()->add_values() = each;
  return json;
}

Json Null() {
  Json json;
  json.set_null_value(google::protobuf::NULL_VALUE);
  return json;
}

std::vector<Case> CasesOf(const std::string& client) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(THUNDERHEAD_CLIENT_CASES)) {
    if (entry.path().extension() == ".json") paths.push_back(entry.path());
  }
  std::ranges::sort(paths);
  std::vector<Case> cases;
  for (const std::filesystem::path& path : paths) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    Struct file;
    Parse(text.str(), file);
    if (!file.fields().at("modules").struct_value().fields().contains(client)) continue;
    for (const Json& each : file.fields().at("cases").list_value().values()) {
      cases.push_back(CaseOf(path.stem(), each.struct_value()));
    }
  }
  return cases;
}

void RunCase(const Runner& runner, const Case& each) {
  Arguments given(each.given);
  const Actions actions = runner(given);
  given.ExpectAllRead();
  const auto expects = [](const Struct& step) { return step.fields().contains("expect"); };
  if (std::ranges::none_of(each.steps, expects)) throw CaseError("the case expects nothing");
  for (std::size_t i = 0; i < each.steps.size(); ++i) {
    try {
      RunStep(actions, each.steps.at(i));
    } catch (const CaseError& error) {
      throw CaseError(absl::StrCat("step ", i, ", ", TextOf(each.steps.at(i)), ": ", error.what()));
    }
  }
}

}  // namespace thunderhead::client::testing
