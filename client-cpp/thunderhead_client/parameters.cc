#include "thunderhead_client/parameters.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "thunderhead/v1/limits.pb.h"

namespace thunderhead::client {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;
using Steps = std::vector<Parameter::Step>;

std::string Words(std::string text) {
  std::replace(text.begin(), text.end(), '_', ' ');
  if (!text.empty()) text[0] = absl::ascii_toupper(static_cast<unsigned char>(text[0]));
  return text;
}

std::string NameOf(const std::string& field) {
  constexpr std::array<const char*, 9> kUnits{
      "_kg_per_m3", "_per_m", "_milliseconds", "_deg", "_mm", "_px", "_ev", "_m", ""};
  for (const std::string unit : kUnits) {
    if (absl::EndsWith(field, unit)) return Words(field.substr(0, field.size() - unit.size()));
  }
  return Words(field);
}

// Returns the name of an option: "filmic" for "TONE_MAP_FILMIC" of ToneMap.
std::string OptionName(const google::protobuf::EnumValueDescriptor& value) {
  std::string prefix;
  for (const char letter : value.type()->name()) {
    if (absl::ascii_isupper(static_cast<unsigned char>(letter)) && !prefix.empty()) prefix += '_';
    prefix += absl::ascii_toupper(static_cast<unsigned char>(letter));
  }
  std::string name = value.name();
  if (absl::StartsWith(name, prefix + "_")) name.erase(0, prefix.size() + 1);
  std::string words = absl::AsciiStrToLower(name);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

// Returns the text of enumerator 0, such as "default: filmic". It is only "default" if the schema
// declares no default_choice.
std::string DefaultName(const FieldDescriptor& field) {
  const std::string& choice = field.options().GetExtension(v1::default_choice);
  const auto* const value = field.enum_type()->FindValueByName(choice);
  return value == nullptr ? "default" : absl::StrCat("default: ", OptionName(*value));
}

std::optional<Parameter::Kind> KindOf(const FieldDescriptor& field) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_ENUM:
      return Parameter::Kind::kChoice;
    case FieldDescriptor::CPPTYPE_BOOL:
      return Parameter::Kind::kFlag;
    case FieldDescriptor::CPPTYPE_STRING:
      return Parameter::Kind::kText;
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return {};
    default:
      return Parameter::Kind::kNumber;
  }
}

// Walks through the messages and lists their parameters.
class Walk {
 public:
  void Of(const Message& message, const std::string& prefix) {
    const Descriptor& descriptor = *message.GetDescriptor();
    for (int i = 0; i < descriptor.field_count(); ++i) Field(message, *descriptor.field(i), prefix);
  }

  std::vector<Parameter> found;

 private:
  void Field(const Message& owner, const FieldDescriptor& field, const std::string& prefix) {
    const Reflection& reflection = *owner.GetReflection();
    if (field.is_map()) return;
    // Lists only the case of a oneof that is set. For an optional field, which Protobuf stores as a
    // oneof with one case, real_containing_oneof() returns null.
    if (field.real_containing_oneof() != nullptr && !reflection.HasField(owner, &field)) return;
    const bool outermost = steps_.empty();
    if (outermost) group_ = field.name();
    const std::string path = prefix + field.name();
    if (field.is_repeated()) {
      if (field.cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) return;
      for (int i = 0; i < reflection.FieldSize(owner, &field); ++i) {
        steps_.push_back({&field, i});
        Of(reflection.GetRepeatedMessage(owner, &field, i), absl::StrCat(path, "[", i, "]."));
        steps_.pop_back();
      }
      return;
    }
    steps_.push_back({&field});
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      Of(reflection.GetMessage(owner, &field), path + ".");
    } else {
      Leaf(field, path);
    }
    steps_.pop_back();
  }

  void Leaf(const FieldDescriptor& field, const std::string& path) {
    const auto kind = KindOf(field);
    if (!kind) return;
    Parameter parameter;
    parameter.path = path;
    parameter.full_name = field.full_name();
    parameter.name = NameOf(field.name());
    parameter.group = group_;
    parameter.kind = *kind;
    parameter.steps = steps_;
    if (*kind == Parameter::Kind::kNumber) parameter.limits = LimitsOf(field);
    parameter.default_on = field.options().GetExtension(v1::default_on);
    if (*kind == Parameter::Kind::kChoice) {
      for (int i = 0; i < field.enum_type()->value_count(); ++i) {
        const auto& value = *field.enum_type()->value(i);
        parameter.options.emplace_back(
            value.number(), value.number() == 0 ? DefaultName(field) : OptionName(value));
      }
    }
    found.push_back(std::move(parameter));
  }

  Steps steps_;
  std::string group_;
};

// Returns the message that contains the parameter's field. Returns null if a message or a list
// element on the path is absent.
const Message* Holder(const v1::Scene& scene, const Steps& steps) {
  const Message* at = &scene;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    const Reflection& reflection = *at->GetReflection();
    const auto& [field, index] = steps[i];
    if (index >= 0) {
      if (index >= reflection.FieldSize(*at, field)) return nullptr;
      at = &reflection.GetRepeatedMessage(*at, field, index);
    } else {
      if (!reflection.HasField(*at, field)) return nullptr;
      at = &reflection.GetMessage(*at, field);
    }
  }
  return at;
}

// Returns the message that holds the parameter; null if an element of a list on the path no longer
// exists.
Message* MutableHolder(v1::Scene& scene, const Steps& steps) {
  Message* at = &scene;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    const Reflection& reflection = *at->GetReflection();
    const auto& [field, index] = steps[i];
    if (index >= 0) {
      if (index >= reflection.FieldSize(*at, field)) return nullptr;
      at = reflection.MutableRepeatedMessage(at, field, index);
    } else {
      at = reflection.MutableMessage(at, field);
    }
  }
  return at;
}

}  // namespace

std::vector<Parameter> ParametersOf(const v1::Scene& scene) {
  Walk walk;
  walk.Of(scene, "");
  return std::move(walk.found);
}

std::optional<double> NumberIn(const v1::Scene& scene, const Parameter& parameter) {
  const Message* const holder = Holder(scene, parameter.steps);
  if (holder == nullptr) return {};
  const FieldDescriptor* const field = parameter.steps.back().field;
  const Reflection& reflection = *holder->GetReflection();
  if (field->has_presence() && !reflection.HasField(*holder, field)) return {};
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return reflection.GetBool(*holder, field) ? 1.0 : 0.0;
    case FieldDescriptor::CPPTYPE_ENUM:
      return reflection.GetEnumValue(*holder, field);
    case FieldDescriptor::CPPTYPE_FLOAT:
      return reflection.GetFloat(*holder, field);
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return reflection.GetDouble(*holder, field);
    case FieldDescriptor::CPPTYPE_UINT32:
      return reflection.GetUInt32(*holder, field);
    case FieldDescriptor::CPPTYPE_INT32:
      return reflection.GetInt32(*holder, field);
    default:
      return {};
  }
}

std::string TextIn(const v1::Scene& scene, const Parameter& parameter) {
  const Message* const holder = Holder(scene, parameter.steps);
  if (holder == nullptr) return "";
  return holder->GetReflection()->GetString(*holder, parameter.steps.back().field);
}

void SetNumber(v1::Scene& scene, const Parameter& parameter, double value) {
  Message* const holder = MutableHolder(scene, parameter.steps);
  if (holder == nullptr) return;
  const FieldDescriptor* const field = parameter.steps.back().field;
  const Reflection& reflection = *holder->GetReflection();
  const double clamped =
      parameter.kind == Parameter::Kind::kNumber ? Clamp(value, parameter.limits) : value;
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return reflection.SetBool(holder, field, value != 0.0);
    case FieldDescriptor::CPPTYPE_ENUM:
      return reflection.SetEnumValue(holder, field, static_cast<int>(value));
    case FieldDescriptor::CPPTYPE_FLOAT:
      return reflection.SetFloat(holder, field, static_cast<float>(clamped));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return reflection.SetDouble(holder, field, clamped);
    case FieldDescriptor::CPPTYPE_UINT32:
      return reflection.SetUInt32(holder, field, static_cast<std::uint32_t>(clamped));
    case FieldDescriptor::CPPTYPE_INT32:
      return reflection.SetInt32(holder, field, static_cast<std::int32_t>(clamped));
    default:
      return;
  }
}

void SetText(v1::Scene& scene, const Parameter& parameter, const std::string& value) {
  Message* const holder = MutableHolder(scene, parameter.steps);
  if (holder == nullptr) return;
  holder->GetReflection()->SetString(holder, parameter.steps.back().field, value);
}

void Clear(v1::Scene& scene, const Parameter& parameter) {
  if (Holder(scene, parameter.steps) == nullptr) return;
  Message* const holder = MutableHolder(scene, parameter.steps);
  holder->GetReflection()->ClearField(holder, parameter.steps.back().field);
}

}  // namespace thunderhead::client
