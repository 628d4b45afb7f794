#include "gateway/tls_contexts.h"

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "spdlog/spdlog.h"

namespace thunderhead::gateway {
namespace {

namespace ssl = boost::asio::ssl;
using boost::system::error_code;

absl::Status CannotLoad(const std::string& what, const std::string& path, const error_code& error) {
  return absl::InvalidArgumentError(
      absl::StrCat("cannot take ", path, " as the ", what, " of TLS: ", error.message(),
                   "; it must be a PEM file that fits the other one"));
}

}  // namespace

absl::StatusOr<TlsContexts> TlsContexts::Open(std::string certificate, std::string key) {
  TlsContexts contexts(std::move(certificate), std::move(key));
  contexts.stamps_ = contexts.Look();
  THUNDERHEAD_RETURN_IF_ERROR(contexts.Load());
  return contexts;
}

TlsContexts::Stamps TlsContexts::Look() const {
  return {base::StampOf(certificate_), base::StampOf(key_)};
}

absl::Status TlsContexts::Load() {
  auto context = std::make_shared<ssl::context>(ssl::context::tls_server);
  error_code error;
  context->set_options(ssl::context::default_workarounds | ssl::context::no_tlsv1 |
                           ssl::context::no_tlsv1_1 | ssl::context::no_compression,
                       error);
  context->use_certificate_chain_file(certificate_, error);
  if (error) return CannotLoad("certificate", certificate_, error);
  // Fails for the key of another certificate.
  context->use_private_key_file(key_, ssl::context::pem, error);
  if (error) return CannotLoad("key", key_, error);
  newest_ = std::move(context);
  return absl::OkStatus();
}

std::shared_ptr<ssl::context> TlsContexts::Current() {
  // One of the two files is replaced before the other: until they match, the old ones are used.
  if (const Stamps stamps = Look(); stamps != stamps_) {
    stamps_ = stamps;
    const absl::Status loaded = Load();
    if (loaded.ok()) {
      spdlog::info("{} has changed and was loaded", certificate_);
    } else {
      spdlog::warn("TLS goes on with the former certificate: {}", std::string(loaded.message()));
    }
  }
  return newest_;
}

}  // namespace thunderhead::gateway
