// Tests which services and files gRPC's reflection describes.
#include "rpc_port/reflected_services.h"

#include <google/protobuf/descriptor.pb.h>

#include <algorithm>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "gtest/gtest.h"
#include "thunderhead/v1/job.pb.h"
#include "thunderhead/v1/limits.pb.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::rpc_port {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::UnorderedElementsAreArray;
using Request = ReflectedServices::Request;
using Response = ReflectedServices::Response;

constexpr int kInvalidArgument = 3;
constexpr int kNotFound = 5;

Request File(const std::string& name) {
  Request request;
  request.set_file_by_filename(name);
  return request;
}

Request Symbol(const std::string& name) {
  Request request;
  request.set_file_containing_symbol(name);
  return request;
}

Request Extension(const std::string& type, int number) {
  Request request;
  request.mutable_file_containing_extension()->set_containing_type(type);
  request.mutable_file_containing_extension()->set_extension_number(number);
  return request;
}

Request Extensions(const std::string& type) {
  Request request;
  request.set_all_extension_numbers_of_type(type);
  return request;
}

class ReflectedServicesTest : public ::testing::Test {
 protected:
  Response Ask(const Request& request) const {
    Response response;
    response.mutable_error_response()->set_error_message("an earlier answer");
    services_.Answer(request, response);
    return response;
  }
  int Code(const Request& request) const { return Ask(request).error_response().error_code(); }
  std::vector<std::string> Files(const Request& request) const {
    const Response response = Ask(request);
    std::vector<std::string> names;
    for (const auto& bytes : response.file_descriptor_response().file_descriptor_proto()) {
      google::protobuf::FileDescriptorProto file;
      EXPECT_TRUE(file.ParseFromString(bytes));
      names.push_back(file.name());
    }
    return names;
  }

  // The program knows this file, but no message of ThunderheadService needs it.
  const std::string foreign_file_ = v1::RenderJob::descriptor()->file()->name();
  const std::string foreign_message_ = v1::RenderJob::descriptor()->full_name();
  const ReflectedServices services_{{v1::ThunderheadService::service_full_name()}};
};

TEST_F(ReflectedServicesTest, AFileComesFirstAndThenAllThatItImports) {
  const std::vector<std::string> files = Files(Symbol("thunderhead.v1.ThunderheadService"));
  ASSERT_FALSE(files.empty());
  EXPECT_EQ(files.front(), "thunderhead/v1/thunderhead.proto");
  EXPECT_THAT(files, Contains("thunderhead/v1/limits.proto")) << "imported by other files only";
  EXPECT_THAT(files, Contains("google/protobuf/descriptor.proto"));
  std::vector<std::string> once = files;
  std::ranges::sort(once);
  EXPECT_EQ(std::ranges::unique(once).begin(), once.end());
  EXPECT_EQ(Files(File("thunderhead/v1/thunderhead.proto")), files);
  EXPECT_THAT(Files(File("google/protobuf/descriptor.proto")),
              ElementsAre("google/protobuf/descriptor.proto"));
}

TEST_F(ReflectedServicesTest, NamesOfEachKindAreFound) {
  for (const char* name :
       {"thunderhead.v1.ThunderheadService.ListStorms", "thunderhead.v1.ListStormsRequest",
        "thunderhead.v1.Scene.fields", "thunderhead.v1.Cumulus.Component",
        "thunderhead.v1.default_on", "google.protobuf.FileDescriptorProto"}) {
    EXPECT_THAT(Files(Symbol(name)), Not(IsEmpty())) << name;
  }
}

TEST_F(ReflectedServicesTest, AnExtensionIsFoundByItsNumber) {
  const int number = v1::default_on.number();
  EXPECT_EQ(Files(Extension("google.protobuf.FieldOptions", number)).front(),
            "thunderhead/v1/limits.proto");
  EXPECT_EQ(Code(Extension("google.protobuf.FieldOptions", -1)), kNotFound);
  EXPECT_EQ(Code(Extension("google.protobuf.FieldOptions", 1)), kNotFound) << "no extension";
  EXPECT_EQ(Code(Extension("thunderhead.v1.Scene", 1)), kNotFound);
  EXPECT_EQ(Code(Extension("thunderhead.v1.Nothing", 1)), kNotFound);
}

TEST_F(ReflectedServicesTest, AllExtensionsOfAMessageAreListed) {
  std::vector<int> declared;
  const auto* const limits = google::protobuf::DescriptorPool::generated_pool()->FindFileByName(
      "thunderhead/v1/limits.proto");
  for (int i = 0; i < limits->extension_count(); ++i) {
    const auto& extension = *limits->extension(i);
    if (extension.containing_type()->name() == "FieldOptions") {
      declared.push_back(extension.number());
    }
  }
  ASSERT_FALSE(declared.empty());
  const Response response = Ask(Extensions("google.protobuf.FieldOptions"));
  const auto& found = response.all_extension_numbers_response();
  EXPECT_EQ(found.base_type_name(), "google.protobuf.FieldOptions");
  EXPECT_THAT(found.extension_number(), UnorderedElementsAreArray(declared));
  const Response none = Ask(Extensions("thunderhead.v1.Scene"));
  EXPECT_TRUE(none.has_all_extension_numbers_response());
  EXPECT_EQ(Code(Extensions("thunderhead.v1.Nothing")), kNotFound);
}

TEST_F(ReflectedServicesTest, FilesThatNoServiceNeedsAreUnknown) {
  EXPECT_EQ(Code(File(foreign_file_)), kNotFound);
  EXPECT_EQ(Code(Symbol(foreign_message_)), kNotFound);
  EXPECT_EQ(Code(Extensions(foreign_message_)), kNotFound);
  EXPECT_EQ(Code(Symbol(grpc::health::v1::Health::service_full_name())), kNotFound);
}

TEST_F(ReflectedServicesTest, OddNamesAreUnknown) {
  using namespace std::string_literals;
  for (const std::string& name :
       {""s, "."s, ".."s, ".thunderhead.v1.Scene"s, "thunderhead.v1.Scene."s, "thunderhead..v1"s,
        "thunderhead.v1.Scene\0"s, "\0"s, "../../etc/passwd"s, "%s%n"s, "\xc3\xa9"s,
        std::string(1 << 20, '.'), std::string(1 << 20, 'a')}) {
    for (const Request& request :
         {File(name), Symbol(name), Extension(name, 50'000), Extensions(name)}) {
      const Response response = Ask(request);
      EXPECT_EQ(response.error_response().error_code(), kNotFound);
      EXPECT_LT(response.error_response().error_message().size(), 3000U);
    }
  }
}

TEST_F(ReflectedServicesTest, ARequestWithoutAQuestionIsInvalid) {
  const Response response = Ask(Request());
  EXPECT_EQ(response.error_response().error_code(), kInvalidArgument);
  EXPECT_THAT(response.error_response().error_message(), HasSubstr("message_request"));
}

TEST_F(ReflectedServicesTest, AnAnswerRepeatsItsRequest) {
  Request request;
  request.set_host("storms.example");
  request.set_list_services("*");
  const Response response = Ask(request);
  EXPECT_EQ(response.valid_host(), "storms.example");
  EXPECT_EQ(response.original_request().SerializeAsString(), request.SerializeAsString());
  ASSERT_EQ(response.list_services_response().service_size(), 1);
  EXPECT_EQ(response.list_services_response().service(0).name(),
            "thunderhead.v1.ThunderheadService");
}

}  // namespace
}  // namespace thunderhead::rpc_port
