// The certificate of gRPC's port. gRPC 1.51 can follow files. However, it ends the process if one
// of them is empty, as a file is while another program writes it. It also serves a certificate that
// does not belong to the key. This class therefore gives gRPC a copy in memory, which is replaced
// only by files that OpenSSL accepts.
#pragma once

#include <grpcpp/security/server_credentials.h>

#include <memory>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "base/certificate_files.h"
#include "base/file_descriptor.h"
#include "base/time_source.h"

namespace thunderhead::rpc_port {

class GrpcCertificate {
 public:
  // Returns INVALID_ARGUMENT if the files cannot be read or do not match, and UNAVAILABLE without a
  // free file descriptor. `time` must outlive this object.
  static absl::StatusOr<std::unique_ptr<GrpcCertificate>> Open(
      const base::TlsFiles& files, const base::TimeSource& time = base::SteadyTime());

  // The path of the copy, which holds the certificate and then the key.
  std::string CopyPath() const;

  // The object must outlive a server with these credentials. gRPC looks for a new copy every few
  // seconds.
  std::shared_ptr<grpc::ServerCredentials> Credentials() const;

 private:
  GrpcCertificate(std::shared_ptr<const base::FileDescriptor> copy,
                  std::unique_ptr<base::CertificateFiles> files)
      : copy_(std::move(copy)), files_(std::move(files)) {}

  const std::shared_ptr<const base::FileDescriptor> copy_;  // certificate and key
  const std::unique_ptr<base::CertificateFiles> files_;
};

}  // namespace thunderhead::rpc_port
