#include "rpc_port/reflected_services.h"

#include <google/protobuf/descriptor.pb.h>

#include <string_view>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "rpc_port/status_table.h"

namespace thunderhead::rpc_port {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::DescriptorPool;
using google::protobuf::FieldDescriptor;
using google::protobuf::FileDescriptor;

absl::Status Unknown(std::string_view what, const std::string& name) {
  return absl::NotFoundError(absl::StrCat(
      "the server's services use no ", absl::string_view(what.data(), what.size()), " \"", name,
      "\"; list the services and the files that describe them to find known names"));
}

}  // namespace

ReflectedServices::ReflectedServices(std::vector<std::string> services)
    : services_(std::move(services)) {
  for (const std::string& service : services_) {
    const auto* const known = DescriptorPool::generated_pool()->FindServiceByName(service);
    THUNDERHEAD_CHECK(known != nullptr, "the program has no service " + service);
    Add(*known->file());
  }
}

void ReflectedServices::Add(const FileDescriptor& file) {
  if (pool_.FindFileByName(file.name()) != nullptr) return;
  for (int i = 0; i < file.dependency_count(); ++i) Add(*file.dependency(i));
  google::protobuf::FileDescriptorProto message;
  file.CopyTo(&message);
  const FileDescriptor* const added = pool_.BuildFile(message);
  THUNDERHEAD_CHECK(added != nullptr, file.name() + " cannot be added to a pool");
  serialized_[added] = message.SerializeAsString();
}

absl::StatusOr<const FileDescriptor*> ReflectedServices::FindFile(const Request& request) const {
  if (request.has_file_by_filename()) {
    const FileDescriptor* const file = pool_.FindFileByName(request.file_by_filename());
    if (file == nullptr) return Unknown("file", request.file_by_filename());
    return file;
  }
  if (request.has_file_containing_symbol()) {
    const std::string& symbol = request.file_containing_symbol();
    const FileDescriptor* const file = pool_.FindFileContainingSymbol(symbol);
    if (file == nullptr) return Unknown("symbol", symbol);
    return file;
  }
  const auto& wanted = request.file_containing_extension();
  const Descriptor* const extended = pool_.FindMessageTypeByName(wanted.containing_type());
  if (extended == nullptr) return Unknown("message", wanted.containing_type());
  const FieldDescriptor* const extension =
      pool_.FindExtensionByNumber(extended, wanted.extension_number());
  if (extension == nullptr) {
    return Unknown("extension",
                   absl::StrCat(extended->full_name(), ":", wanted.extension_number()));
  }
  return extension->file();
}

void ReflectedServices::AppendFiles(
    const File& file, std::set<const File*>& appended,
    grpc::reflection::v1alpha::FileDescriptorResponse& files) const {
  if (!appended.insert(&file).second) return;
  files.add_file_descriptor_proto(serialized_.at(&file));
  for (int i = 0; i < file.dependency_count(); ++i) {
    AppendFiles(*file.dependency(i), appended, files);
  }
}

void ReflectedServices::Answer(const Request& request, Response& response) const {
  response.Clear();
  response.set_valid_host(request.host());
  *response.mutable_original_request() = request;
  const auto refuse = [&response](const absl::Status& why) {
    response.mutable_error_response()->set_error_code(CodeOf(why));
    response.mutable_error_response()->set_error_message(SendableMessage(why));
  };
  switch (request.message_request_case()) {
    case Request::kListServices:
      for (const std::string& service : services_) {
        response.mutable_list_services_response()->add_service()->set_name(service);
      }
      return;
    case Request::kFileByFilename:
    case Request::kFileContainingSymbol:
    case Request::kFileContainingExtension: {
      const absl::StatusOr<const File*> file = FindFile(request);
      if (!file.ok()) return refuse(file.status());
      std::set<const File*> appended;
      return AppendFiles(**file, appended, *response.mutable_file_descriptor_response());
    }
    case Request::kAllExtensionNumbersOfType: {
      const std::string& type = request.all_extension_numbers_of_type();
      const Descriptor* const extended = pool_.FindMessageTypeByName(type);
      if (extended == nullptr) return refuse(Unknown("message", type));
      std::vector<const FieldDescriptor*> extensions;
      pool_.FindAllExtensions(extended, &extensions);
      auto& numbers = *response.mutable_all_extension_numbers_response();
      numbers.set_base_type_name(type);
      for (const auto* extension : extensions) numbers.add_extension_number(extension->number());
      return;
    }
    case Request::MESSAGE_REQUEST_NOT_SET:
      return refuse(absl::InvalidArgumentError(
          "message_request is missing; set one of its fields, such as list_services"));
  }
}

}  // namespace thunderhead::rpc_port
