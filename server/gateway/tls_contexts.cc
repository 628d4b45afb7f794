#include "gateway/tls_contexts.h"

#include <boost/asio/buffer.hpp>
#include <mutex>
#include <utility>

#include "base/status.h"

namespace thunderhead::gateway {
namespace {

namespace ssl = boost::asio::ssl;
using boost::system::error_code;

}  // namespace

struct TlsContexts::Newest {
  std::mutex mutex;
  std::shared_ptr<ssl::context> context;
};

absl::StatusOr<std::unique_ptr<TlsContexts>> TlsContexts::Open(const base::TlsFiles& files,
                                                               const base::TimeSource& time) {
  const auto newest = std::make_shared<Newest>();
  const auto take = [newest, files](const base::CertificatePem& pem) {
    auto context = std::make_shared<ssl::context>(ssl::context::tls_server);
    error_code error;
    context->set_options(ssl::context::default_workarounds | ssl::context::no_tlsv1 |
                             ssl::context::no_tlsv1_1 | ssl::context::no_compression,
                         error);
    context->use_certificate_chain(boost::asio::buffer(pem.certificate), error);
    if (error) return base::CannotUseForTls("certificate", files.certificate, error.message());
    // This call fails if the key does not belong to the certificate.
    context->use_private_key(boost::asio::buffer(pem.key), ssl::context::pem, error);
    if (error) return base::CannotUseForTls("key", files.key, error.message());
    const std::lock_guard lock(newest->mutex);
    newest->context = std::move(context);
    return absl::OkStatus();
  };
  std::unique_ptr<TlsContexts> contexts(new TlsContexts(newest));
  THUNDERHEAD_ASSIGN_OR_RETURN(contexts->files_, base::CertificateFiles::Open(files, take, time));
  return contexts;
}

std::shared_ptr<ssl::context> TlsContexts::Current() {
  const std::lock_guard lock(newest_->mutex);
  return newest_->context;
}

}  // namespace thunderhead::gateway
