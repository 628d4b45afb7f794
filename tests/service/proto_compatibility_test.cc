// The wire format of thunderhead.v1 that existing clients rely on: tests/service/v1_wire_format.txt
// lists every field, enumerator and call. Removing, renaming or renumbering one, or changing its
// type, breaks them. A new one belongs in the list: run this test with THUNDERHEAD_UPDATE=1 set.
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "google/protobuf/descriptor.h"
#include "gtest/gtest.h"
#include "thunderhead/v1/job.pb.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;
using Lines = std::set<std::string>;

constexpr char kListPath[] = THUNDERHEAD_SOURCE_DIR "/tests/service/v1_wire_format.txt";

std::string TypeOf(const FieldDescriptor& field) {
  if (field.message_type() != nullptr) return field.message_type()->full_name();
  if (field.enum_type() != nullptr) return field.enum_type()->full_name();
  return field.type_name();
}

void Add(const EnumDescriptor& type, Lines* lines) {
  for (int i = 0; i < type.value_count(); ++i) {
    lines->insert(absl::StrCat("enumerator ", type.full_name(), ".", type.value(i)->name(), " = ",
                               type.value(i)->number()));
  }
}

void Add(const Descriptor& message, Lines* lines) {
  for (int i = 0; i < message.field_count(); ++i) {
    const FieldDescriptor& field = *message.field(i);
    lines->insert(absl::StrCat("field ", message.full_name(), ".", field.name(), " = ",
                               field.number(), " ", field.is_repeated() ? "repeated " : "",
                               field.has_presence() ? "optional " : "", TypeOf(field)));
  }
  for (int i = 0; i < message.nested_type_count(); ++i) Add(*message.nested_type(i), lines);
  for (int i = 0; i < message.enum_type_count(); ++i) Add(*message.enum_type(i), lines);
}

Lines Current() {
  Lines lines;
  const google::protobuf::FileDescriptor* service_file =
      v1::GetServerInfoRequest::descriptor()->file();
  const google::protobuf::FileDescriptor* job_file = v1::GetRenderJobRequest::descriptor()->file();
  std::set<const google::protobuf::FileDescriptor*> files = {service_file, job_file};
  for (int i = 0; i < service_file->dependency_count(); ++i) {
    files.insert(service_file->dependency(i));
  }
  for (const auto* file : files) {
    if (file->package() != "thunderhead.v1") continue;
    for (int i = 0; i < file->message_type_count(); ++i) Add(*file->message_type(i), &lines);
    for (int i = 0; i < file->enum_type_count(); ++i) Add(*file->enum_type(i), &lines);
    for (int i = 0; i < file->service_count(); ++i) {
      for (int j = 0; j < file->service(i)->method_count(); ++j) {
        const google::protobuf::MethodDescriptor& call = *file->service(i)->method(j);
        lines.insert(absl::StrCat("call ", call.full_name(), " ", call.input_type()->full_name(),
                                  call.client_streaming() ? " stream" : "", " -> ",
                                  call.output_type()->full_name(),
                                  call.server_streaming() ? " stream" : ""));
      }
    }
  }
  return lines;
}

Lines Listed() {
  std::ifstream file(kListPath);
  Lines lines;
  for (std::string line; std::getline(file, line);) lines.insert(line);
  return lines;
}

std::string Without(const Lines& lines, const Lines& others) {
  std::string text;
  for (const std::string& line : lines) {
    if (!others.contains(line)) absl::StrAppend(&text, "  ", line, "\n");
  }
  return text;
}

TEST(ProtoCompatibility, WhatClientsKnowStaysAsItIs) {
  const Lines current = Current();
  ASSERT_GT(current.size(), 200U);
  if (std::getenv("THUNDERHEAD_UPDATE") != nullptr) {
    std::ofstream file(kListPath);
    for (const std::string& line : current) file << line << "\n";
  }
  const Lines listed = Listed();
  EXPECT_EQ(Without(listed, current), "") << "clients know these; they must not change";
  EXPECT_EQ(Without(current, listed), "") << "these are new; add them by THUNDERHEAD_UPDATE=1";
}

// A removed number or name is not reused.
TEST(ProtoCompatibility, FormerNumbersStayReserved) {
  const Descriptor& rendering = *v1::Rendering::descriptor();
  for (int number = 1; number <= 10; ++number) EXPECT_TRUE(rendering.IsReservedNumber(number));
  EXPECT_TRUE(rendering.IsReservedName("mode"));
  EXPECT_TRUE(rendering.IsReservedName("renderer"));
  EXPECT_TRUE(v1::FieldParameters::descriptor()->IsReservedNumber(10));
  EXPECT_TRUE(v1::FieldParameters::descriptor()->IsReservedName("size_from_file"));
  EXPECT_TRUE(v1::StageCost::descriptor()->IsReservedNumber(1));
  EXPECT_TRUE(v1::Modelled::descriptor()->IsReservedNumber(5));
  EXPECT_TRUE(v1::AccuracyReport::descriptor()->IsReservedNumber(10));
  EXPECT_TRUE(v1::End_Reason_descriptor()->IsReservedNumber(3));
  EXPECT_TRUE(v1::End_Reason_descriptor()->IsReservedName("REASON_IDLE"));
}

}  // namespace
}  // namespace thunderhead::service
