// Tests of the wire format of thunderhead.v1 that existing clients rely on:
// tests/service/v1_wire_format.txt lists it. THUNDERHEAD_UPDATE=1 rewrites the list after an
// addition, or after a removal whose number and name are reserved. It does not accept a change that
// breaks clients.
#include <cstdlib>
#include <fstream>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/descriptor.pb.h"
#include "google/protobuf/text_format.h"
#include "gtest/gtest.h"
#include "tests/service/wire_format.h"
#include "thunderhead/v1/job.pb.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {
namespace {

using google::protobuf::FileDescriptor;
using ::testing::HasSubstr;

constexpr char kListPath[] = THUNDERHEAD_SOURCE_DIR "/tests/service/v1_wire_format.txt";

void AddWithImports(const FileDescriptor* file, std::set<const FileDescriptor*>* files) {
  if (file->package() != "thunderhead.v1" || !files->insert(file).second) return;
  for (int i = 0; i < file->dependency_count(); ++i) AddWithImports(file->dependency(i), files);
}

FormatLines Current() {
  std::set<const FileDescriptor*> files;
  AddWithImports(v1::GetServerInfoRequest::descriptor()->file(), &files);
  AddWithImports(v1::GetRenderJobRequest::descriptor()->file(), &files);
  return FormatLinesOf(files);
}

FormatLines Listed() {
  std::ifstream file(kListPath);
  FormatLines lines;
  for (std::string line; std::getline(file, line);) lines.insert(line);
  return lines;
}

TEST(ProtoCompatibility, TheListedFormatStillHolds) {
  const FormatLines current = Current();
  ASSERT_GT(current.size(), 700U);
  const FormatLines listed = Listed();
  const std::string broken = Breaks(listed, current);
  ASSERT_EQ(broken, "") << "clients rely on these; reserve the number and the name of a field or "
                           "an enumerator that is removed";
  if (std::getenv("THUNDERHEAD_UPDATE") != nullptr) {
    std::ofstream file(kListPath);
    for (const std::string& line : current) file << line << "\n";
    return;
  }
  EXPECT_TRUE(current == listed)
      << "the format has additions, or removals with reservations; list them by running this test "
         "with THUNDERHEAD_UPDATE=1";
}

// Returns the format of a message M with oneof `o` and these fields, in the text format of
// descriptors.
FormatLines FormatOf(const std::string& fields) {
  google::protobuf::FileDescriptorProto file;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      absl::StrCat("name: 'm.proto' package: 'p' syntax: 'proto3' message_type { name: 'M' ",
                   fields, " field { name: 'z' number: 9 label: LABEL_OPTIONAL type: TYPE_INT32 ",
                   "oneof_index: 0 } oneof_decl { name: 'o' } }"),
      &file));
  google::protobuf::DescriptorPool pool;
  return FormatLinesOf({pool.BuildFile(file)});
}

std::string Field(const std::string& name, int number, const std::string& type,
                  const std::string& more = "") {
  return absl::StrCat(" field { name: '", name, "' number: ", number,
                      " label: LABEL_OPTIONAL type: ", type, " ", more, "} ");
}

TEST(ProtoCompatibility, RemovalsRenamingsAndChangesOfTypeBreakClients) {
  const FormatLines listed = FormatOf(Field("a", 1, "TYPE_INT32"));
  EXPECT_EQ(Breaks(listed, listed), "");
  EXPECT_EQ(Breaks(listed, FormatOf(Field("a", 1, "TYPE_INT32") + Field("b", 2, "TYPE_BOOL"))), "");
  const std::string gone = "gone: field p.M.a = 1";
  EXPECT_THAT(Breaks(listed, FormatOf("")), HasSubstr(gone));
  EXPECT_THAT(Breaks(listed, FormatOf(Field("b", 1, "TYPE_INT32"))), HasSubstr(gone));
  EXPECT_THAT(Breaks(listed, FormatOf(Field("a", 2, "TYPE_INT32"))), HasSubstr(gone));
  EXPECT_THAT(Breaks(listed, FormatOf(Field("a", 1, "TYPE_INT64"))), HasSubstr(gone));
}

TEST(ProtoCompatibility, AFieldMayGoIfItsNumberAndItsNameAreReservedForEver) {
  const FormatLines listed = FormatOf(Field("a", 1, "TYPE_INT32"));
  const std::string number = " reserved_range { start: 1 end: 2 } ";
  const std::string name = " reserved_name: 'a' ";
  EXPECT_EQ(Breaks(listed, FormatOf(number + name)), "");
  EXPECT_THAT(Breaks(listed, FormatOf(number)), HasSubstr("gone"));
  EXPECT_THAT(Breaks(listed, FormatOf(name)), HasSubstr("gone"));
  EXPECT_THAT(Breaks(FormatOf(number + name), FormatOf("")),
              HasSubstr("gone: reserved p.M number 1"));
}

// Setting a field of a oneof clears its other fields. Clients that know only one of the fields do
// not expect that.
TEST(ProtoCompatibility, AKnownFieldNeitherEntersNorLeavesAOneof) {
  const std::string member = "oneof_index: 0 ";
  const FormatLines outside = FormatOf(Field("a", 1, "TYPE_STRING", "proto3_optional: false "));
  const FormatLines inside = FormatOf(Field("a", 1, "TYPE_STRING", member));
  EXPECT_THAT(Breaks(outside, inside), HasSubstr("moved: oneof p.M.o p.M.a"));
  EXPECT_THAT(Breaks(inside, outside), HasSubstr("gone: oneof p.M.o p.M.a"));
  EXPECT_EQ(Breaks(FormatOf(""), inside), "");
  EXPECT_EQ(Breaks(inside, FormatOf(" reserved_range { start: 1 end: 2 } reserved_name: 'a' ")),
            "");
}

}  // namespace
}  // namespace thunderhead::service
