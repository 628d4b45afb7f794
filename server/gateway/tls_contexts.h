// The TLS contexts of the HTTP port, which follow the files of certificate and key
// (base/certificate_files.h). Open connections keep the certificate with which they began.
#pragma once

#include <boost/asio/ssl/context.hpp>
#include <memory>
#include <utility>

#include "absl/status/statusor.h"
#include "base/certificate_files.h"
#include "base/time_source.h"

namespace thunderhead::gateway {

class TlsContexts {
 public:
  // Loads the files. Returns INVALID_ARGUMENT if they cannot be read or do not match. `time` must
  // outlive this object.
  static absl::StatusOr<std::unique_ptr<TlsContexts>> Open(
      const base::TlsFiles& files, const base::TimeSource& time = base::SteadyTime());

  // Returns the TLS context with the newest files that could be loaded.
  std::shared_ptr<boost::asio::ssl::context> Current();

 private:
  struct Newest;

  explicit TlsContexts(std::shared_ptr<Newest> newest) : newest_(std::move(newest)) {}

  const std::shared_ptr<Newest> newest_;
  std::unique_ptr<base::CertificateFiles> files_;
};

}  // namespace thunderhead::gateway
