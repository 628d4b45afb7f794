// Answers the questions of gRPC's reflection protocol: which services the server has, and which
// files describe them and their messages. It knows no other files.
#pragma once

#include <google/protobuf/descriptor.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "grpc/reflection/v1alpha/reflection.pb.h"

namespace thunderhead::rpc_port {

class ReflectedServices {
 public:
  using Request = grpc::reflection::v1alpha::ServerReflectionRequest;
  using Response = grpc::reflection::v1alpha::ServerReflectionResponse;

  // `services` are full names. The program must contain the generated code of each of them.
  explicit ReflectedServices(std::vector<std::string> services);

  // Sets `response` to the answer. An unknown name is answered with NOT_FOUND, a request without a
  // question with INVALID_ARGUMENT. Safe to call from any thread.
  void Answer(const Request& request, Response& response) const;

 private:
  using File = google::protobuf::FileDescriptor;

  // Adds a file and all files that it imports.
  void Add(const File& file);
  absl::StatusOr<const File*> FindFile(const Request& request) const;
  void AppendFiles(const File& file, std::set<const File*>& appended,
                   grpc::reflection::v1alpha::FileDescriptorResponse& files) const;

  const std::vector<std::string> services_;
  // The files in a pool of their own, so that no question can reach another file.
  google::protobuf::DescriptorPool pool_;
  std::map<const File*, std::string> serialized_;
};

}  // namespace thunderhead::rpc_port
