#include "tests/service/wire_format.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace thunderhead::service {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::FileDescriptor;
using google::protobuf::MethodDescriptor;

std::string TypeOf(const FieldDescriptor& field) {
  if (field.message_type() != nullptr) return field.message_type()->full_name();
  if (field.enum_type() != nullptr) return field.enum_type()->full_name();
  return field.type_name();
}

std::string Declaration(const FieldDescriptor& field) {
  return absl::StrCat(field.full_name(), " = ", field.number(), " ",
                      field.is_repeated() ? "repeated " : "",
                      field.has_presence() ? "optional " : "", TypeOf(field));
}

std::string ReservedNumber(const std::string& type, const std::string& number) {
  return absl::StrCat("reserved ", type, " number ", number);
}

std::string ReservedName(const std::string& type, const std::string& name) {
  return absl::StrCat("reserved ", type, " name ", name);
}

void Add(const EnumDescriptor& type, FormatLines* lines) {
  for (int i = 0; i < type.value_count(); ++i) {
    lines->insert(absl::StrCat("enumerator ", type.full_name(), ".", type.value(i)->name(), " = ",
                               type.value(i)->number()));
  }
  for (int i = 0; i < type.reserved_range_count(); ++i) {
    const EnumDescriptor::ReservedRange& range = *type.reserved_range(i);
    for (int number = range.start; number <= range.end; ++number) {  // the range includes its end
      lines->insert(ReservedNumber(type.full_name(), absl::StrCat(number)));
    }
  }
  for (int i = 0; i < type.reserved_name_count(); ++i) {
    lines->insert(ReservedName(type.full_name(), type.reserved_name(i)));
  }
}

void Add(const Descriptor& message, FormatLines* lines) {
  for (int i = 0; i < message.field_count(); ++i) {
    const FieldDescriptor& field = *message.field(i);
    lines->insert(absl::StrCat("field ", Declaration(field)));
    if (field.real_containing_oneof() != nullptr) {
      lines->insert(absl::StrCat("oneof ", field.real_containing_oneof()->full_name(), " ",
                                 field.full_name()));
    }
  }
  for (int i = 0; i < message.reserved_range_count(); ++i) {
    const Descriptor::ReservedRange& range = *message.reserved_range(i);
    for (int number = range.start; number < range.end; ++number) {
      lines->insert(ReservedNumber(message.full_name(), absl::StrCat(number)));
    }
  }
  for (int i = 0; i < message.reserved_name_count(); ++i) {
    lines->insert(ReservedName(message.full_name(), message.reserved_name(i)));
  }
  for (int i = 0; i < message.nested_type_count(); ++i) Add(*message.nested_type(i), lines);
  for (int i = 0; i < message.enum_type_count(); ++i) Add(*message.enum_type(i), lines);
}

void Add(const MethodDescriptor& call, FormatLines* lines) {
  lines->insert(absl::StrCat("call ", call.full_name(), " ", call.input_type()->full_name(),
                             call.client_streaming() ? " stream" : "", " -> ",
                             call.output_type()->full_name(),
                             call.server_streaming() ? " stream" : ""));
}

// Splits "a.b.C.d" into "a.b.C" and "d".
std::pair<std::string, std::string> SplitName(const std::string& full_name) {
  const std::size_t dot = full_name.rfind('.');
  return {full_name.substr(0, dot), full_name.substr(dot + 1)};
}

// Returns true if the field or enumerator of a listed line was removed and its number and name are
// reserved.
bool IsReserved(const std::vector<std::string>& line, const FormatLines& current) {
  const auto& [type, name] = SplitName(line[1]);
  return current.contains(ReservedName(type, name)) &&
         current.contains(ReservedNumber(type, line[3]));
}

// Returns the listed declaration of a field.
const std::string* FieldLine(const std::string& full_name, const FormatLines& lines) {
  const std::string start = absl::StrCat("field ", full_name, " = ");
  const auto found = lines.lower_bound(start);
  return found != lines.end() && found->starts_with(start) ? &*found : nullptr;
}

bool MayGo(const std::string& line, const FormatLines& listed, const FormatLines& current) {
  const std::vector<std::string> words = absl::StrSplit(line, ' ');
  if (words[0] == "field" || words[0] == "enumerator") return IsReserved(words, current);
  if (words[0] != "oneof") return false;
  const std::string* field = FieldLine(words[2], listed);
  return field != nullptr && !current.contains(*field) && MayGo(*field, listed, current);
}

bool MayCome(const std::string& line, const FormatLines& listed) {
  const std::vector<std::string> words = absl::StrSplit(line, ' ');
  return words[0] != "oneof" || FieldLine(words[2], listed) == nullptr;
}

}  // namespace

FormatLines FormatLinesOf(const std::set<const FileDescriptor*>& files) {
  FormatLines lines;
  for (const FileDescriptor* file : files) {
    for (int i = 0; i < file->message_type_count(); ++i) Add(*file->message_type(i), &lines);
    for (int i = 0; i < file->enum_type_count(); ++i) Add(*file->enum_type(i), &lines);
    for (int i = 0; i < file->extension_count(); ++i) {
      lines.insert(absl::StrCat("extension ", Declaration(*file->extension(i)), " of ",
                                file->extension(i)->containing_type()->full_name()));
    }
    for (int i = 0; i < file->service_count(); ++i) {
      for (int j = 0; j < file->service(i)->method_count(); ++j) {
        Add(*file->service(i)->method(j), &lines);
      }
    }
  }
  return lines;
}

std::string Breaks(const FormatLines& listed, const FormatLines& current) {
  std::string broken;
  for (const std::string& line : listed) {
    if (!current.contains(line) && !MayGo(line, listed, current)) {
      absl::StrAppend(&broken, "  gone: ", line, "\n");
    }
  }
  for (const std::string& line : current) {
    if (!listed.contains(line) && !MayCome(line, listed)) {
      absl::StrAppend(&broken, "  a known field has moved: ", line, "\n");
    }
  }
  return broken;
}

}  // namespace thunderhead::service
