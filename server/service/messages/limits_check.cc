#include "service/messages/limits_check.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/status.h"
#include "thunderhead/v1/limits.pb.h"

namespace thunderhead::service {
namespace {

using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

// Returns the shortest text that parses to the same number.
template <typename Number>
std::string Text(Number value) {
  char buffer[64];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof(buffer), value);
  return std::string(buffer, end);
}

std::string Range(const v1::NumberLimits& limits) {
  std::string text =
      absl::StrCat("between ", Text(limits.minimum()), " and ", Text(limits.maximum()));
  if (!limits.unit().empty() && limits.unit() != "1") absl::StrAppend(&text, " ", limits.unit());
  return text;
}

// A value as text, and whether it is within its limits. The limits are rounded to the value's type
// before the comparison. Otherwise 0.1 as a float would exceed a limit of 0.1, because it is larger
// than 0.1 as a double.
struct Checked {
  std::string text;
  bool within = false;
};

template <typename Number>
Checked Check(Number value, const v1::NumberLimits& limits) {
  const bool within = value >= static_cast<Number>(limits.minimum()) &&
                      value <= static_cast<Number>(limits.maximum());
  return {Text(value), within};
}

// Checks a number; `index` is negative if the field is not repeated.
Checked CheckNumber(const Message& message, const FieldDescriptor& field, int index,
                    const v1::NumberLimits& limits) {
  const Reflection& get = *message.GetReflection();
  const bool one = index < 0;
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_FLOAT:
      return Check(
          one ? get.GetFloat(message, &field) : get.GetRepeatedFloat(message, &field, index),
          limits);
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return Check(
          one ? get.GetDouble(message, &field) : get.GetRepeatedDouble(message, &field, index),
          limits);
    case FieldDescriptor::CPPTYPE_UINT32:
      return Check<std::int64_t>(
          one ? get.GetUInt32(message, &field) : get.GetRepeatedUInt32(message, &field, index),
          limits);
    case FieldDescriptor::CPPTYPE_INT32:
      return Check<std::int64_t>(
          one ? get.GetInt32(message, &field) : get.GetRepeatedInt32(message, &field, index),
          limits);
    default:
      THUNDERHEAD_CHECK(false, absl::StrCat(field.full_name(), " has limits but is no number"));
      return {};
  }
}

std::string NamesOf(const EnumDescriptor& type) {
  std::string names;
  for (int i = 0; i < type.value_count(); ++i) {
    absl::StrAppend(&names, i == 0 ? "" : ", ", type.value(i)->name());
  }
  return names;
}

absl::Status CheckEnum(const Message& message, const FieldDescriptor& field, int index,
                       const std::string& path) {
  const Reflection& get = *message.GetReflection();
  const int value = index < 0 ? get.GetEnumValue(message, &field)
                              : get.GetRepeatedEnumValue(message, &field, index);
  if (field.enum_type()->FindValueByNumber(value) != nullptr) return absl::OkStatus();
  const std::string names = NamesOf(*field.enum_type());
  return base::InvalidField(path, absl::StrCat("is ", value, "; it must be one of ", names),
                            "VALUE_UNKNOWN", {{"allowed", names}});
}

absl::Status CheckString(const Message& message, const FieldDescriptor& field, int index,
                         const std::string& path) {
  if (!field.options().HasExtension(v1::max_length)) return absl::OkStatus();
  const std::size_t longest = field.options().GetExtension(v1::max_length);
  std::string scratch;
  const Reflection& get = *message.GetReflection();
  const std::string& value = index < 0
                                 ? get.GetStringReference(message, &field, &scratch)
                                 : get.GetRepeatedStringReference(message, &field, index, &scratch);
  if (value.size() <= longest) return absl::OkStatus();
  return base::InvalidField(
      path, absl::StrCat("is ", value.size(), " bytes long; it may be at most ", longest, " bytes"),
      "TEXT_TOO_LONG", {{"maximum", absl::StrCat(longest)}, {"unit", "bytes"}});
}

absl::Status CheckMessage(const Message& message, const std::string& prefix);

absl::Status CheckValue(const Message& message, const FieldDescriptor& field, int index,
                        const std::string& path) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_MESSAGE: {
      const Reflection& get = *message.GetReflection();
      return CheckMessage(index < 0 ? get.GetMessage(message, &field)
                                    : get.GetRepeatedMessage(message, &field, index),
                          absl::StrCat(path, "."));
    }
    case FieldDescriptor::CPPTYPE_ENUM:
      return CheckEnum(message, field, index, path);
    case FieldDescriptor::CPPTYPE_STRING:
      return CheckString(message, field, index, path);
    default:
      break;
  }
  if (!field.options().HasExtension(v1::number)) return absl::OkStatus();
  const v1::NumberLimits& limits = field.options().GetExtension(v1::number);
  const Checked checked = CheckNumber(message, field, index, limits);
  if (checked.within) return absl::OkStatus();
  return base::InvalidField(path, absl::StrCat("is ", checked.text, "; it must be ", Range(limits)),
                            "VALUE_OUT_OF_RANGE",
                            {{"minimum", Text(limits.minimum())},
                             {"maximum", Text(limits.maximum())},
                             {"unit", limits.unit()}});
}

absl::Status CheckRepeated(const Message& message, const FieldDescriptor& field,
                           const std::string& path) {
  const int size = message.GetReflection()->FieldSize(message, &field);
  if (field.options().HasExtension(v1::max_items)) {
    const std::uint32_t max_items = field.options().GetExtension(v1::max_items);
    if (static_cast<std::uint32_t>(size) > max_items) {
      return base::InvalidField(
          path, absl::StrCat("has ", size, " items; it may have at most ", max_items),
          "TOO_MANY_ITEMS", {{"maximum", absl::StrCat(max_items)}, {"unit", "items"}});
    }
  }
  for (int i = 0; i < size; ++i) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckValue(message, field, i, absl::StrCat(path, "[", i, "]")));
  }
  return absl::OkStatus();
}

absl::Status CheckMessage(const Message& message, const std::string& prefix) {
  const auto& type = *message.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    const std::string path = absl::StrCat(prefix, field.name());
    if (field.is_repeated()) {
      THUNDERHEAD_RETURN_IF_ERROR(CheckRepeated(message, field, path));
    } else if (!field.has_presence() || message.GetReflection()->HasField(message, &field)) {
      THUNDERHEAD_RETURN_IF_ERROR(CheckValue(message, field, -1, path));
    }
  }
  return absl::OkStatus();
}

void SetNumber(Message& message, const FieldDescriptor& field, double value) {
  const Reflection& set = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_FLOAT:
      return set.SetFloat(&message, &field, static_cast<float>(value));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return set.SetDouble(&message, &field, value);
    case FieldDescriptor::CPPTYPE_UINT32:
      return set.SetUInt32(&message, &field, static_cast<std::uint32_t>(value));
    case FieldDescriptor::CPPTYPE_INT32:
      return set.SetInt32(&message, &field, static_cast<std::int32_t>(value));
    default:
      THUNDERHEAD_CHECK(false, absl::StrCat(field.full_name(), " has limits but is no number"));
  }
}

// Sets `field`, which is not repeated and is absent, to its default. An enumerator with the value 0
// counts as absent.
void FillDefault(Message& message, const FieldDescriptor& field) {
  const google::protobuf::FieldOptions& options = field.options();
  if (options.HasExtension(v1::default_on)) {
    message.GetReflection()->SetBool(&message, &field, options.GetExtension(v1::default_on));
  } else if (options.HasExtension(v1::default_choice)) {
    const std::string& name = options.GetExtension(v1::default_choice);
    const auto* value = field.enum_type()->FindValueByName(name);
    THUNDERHEAD_CHECK(value != nullptr, absl::StrCat(field.full_name(), " has no ", name));
    message.GetReflection()->SetEnum(&message, &field, value);
  } else if (field.has_presence() && options.GetExtension(v1::number).has_default_value()) {
    SetNumber(message, field, options.GetExtension(v1::number).default_value());
  }
}

}  // namespace

absl::Status CheckLimits(const Message& message) { return CheckMessage(message, ""); }

void FillDefaults(Message& message) {
  const Reflection& reflection = *message.GetReflection();
  const auto& type = *message.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    const bool is_message = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    if (field.is_repeated()) {
      for (int j = 0; is_message && j < reflection.FieldSize(message, &field); ++j) {
        FillDefaults(*reflection.MutableRepeatedMessage(&message, &field, j));
      }
    } else if (is_message) {
      if (reflection.HasField(message, &field)) {
        FillDefaults(*reflection.MutableMessage(&message, &field));
      }
    } else if (!reflection.HasField(message, &field)) {
      FillDefault(message, field);
    }
  }
}

}  // namespace thunderhead::service
