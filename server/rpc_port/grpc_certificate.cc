#include "rpc_port/grpc_certificate.h"

#include <fcntl.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::rpc_port {
namespace {

// Interval at which gRPC checks whether the copy has changed.
constexpr unsigned kLookEvery_s = 5;

std::string PathOf(const base::FileDescriptor& file) {
  return absl::StrCat("/proc/self/fd/", file.Get());
}

absl::Status NoMemoryFile() {
  return absl::UnavailableError(
      absl::StrCat("the certificate of TLS cannot be copied (", std::strerror(errno), ")"));
}

// Returns a file in memory with this text.
absl::StatusOr<base::FileDescriptor> MemoryFile(std::string_view text) {
  base::FileDescriptor file(memfd_create("certificate", MFD_CLOEXEC));
  if (!file.IsOpen()) return NoMemoryFile();
  while (!text.empty()) {
    const ssize_t count = write(file.Get(), text.data(), text.size());
    if (count < 0 && errno != EINTR) return NoMemoryFile();
    if (count > 0) text.remove_prefix(static_cast<std::size_t>(count));
  }
  return file;
}

std::string OpenSslError() {
  const char* const reason = ERR_reason_error_string(ERR_get_error());
  return reason == nullptr ? "OpenSSL cannot read it" : reason;
}

// Checks that the file has a certificate and its key.
absl::Status Check(const base::FileDescriptor& file, const base::TlsFiles& names) {
  ERR_clear_error();
  const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(SSL_CTX_new(TLS_server_method()),
                                                                  &SSL_CTX_free);
  if (context == nullptr) return absl::UnavailableError(OpenSslError());
  // Without this, OpenSSL would ask the terminal for the password of an encrypted key.
  SSL_CTX_set_default_passwd_cb(context.get(), [](char*, int, int, void*) { return 0; });
  const std::string path = PathOf(file);
  if (SSL_CTX_use_certificate_chain_file(context.get(), path.c_str()) != 1) {
    return base::CannotUseForTls("certificate", names.certificate, OpenSslError());
  }
  // This call fails if the key does not belong to the certificate.
  if (SSL_CTX_use_PrivateKey_file(context.get(), path.c_str(), SSL_FILETYPE_PEM) != 1) {
    return base::CannotUseForTls("key", names.key, OpenSslError());
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::unique_ptr<GrpcCertificate>> GrpcCertificate::Open(
    const base::TlsFiles& files, const base::TimeSource& time) {
  THUNDERHEAD_ASSIGN_OR_RETURN(base::FileDescriptor empty, MemoryFile(""));
  const auto copy = std::make_shared<const base::FileDescriptor>(std::move(empty));
  const auto take = [copy, files](const base::CertificatePem& pem) -> absl::Status {
    THUNDERHEAD_ASSIGN_OR_RETURN(const base::FileDescriptor next,
                                 MemoryFile(absl::StrCat(pem.certificate, "\n", pem.key)));
    THUNDERHEAD_RETURN_IF_ERROR(Check(next, files));
    // The descriptor keeps its number, and so the copy keeps its path. gRPC opens either the former
    // copy or this one.
    if (dup3(next.Get(), copy->Get(), O_CLOEXEC) < 0) return NoMemoryFile();
    return absl::OkStatus();
  };
  THUNDERHEAD_ASSIGN_OR_RETURN(std::unique_ptr<base::CertificateFiles> watched,
                               base::CertificateFiles::Open(files, take, time));
  return std::unique_ptr<GrpcCertificate>(new GrpcCertificate(copy, std::move(watched)));
}

std::string GrpcCertificate::CopyPath() const { return PathOf(*copy_); }

std::shared_ptr<grpc::ServerCredentials> GrpcCertificate::Credentials() const {
  const std::string path = CopyPath();
  grpc::experimental::TlsServerCredentialsOptions options(
      std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(path, path,
                                                                           kLookEvery_s));
  options.watch_identity_key_cert_pairs();
  options.set_cert_request_type(GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE);
  return grpc::experimental::TlsServerCredentials(options);
}

}  // namespace thunderhead::rpc_port
