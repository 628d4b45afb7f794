// The certificate and key for TLS connections, which are loaded again when their files change. Open
// connections keep the certificate with which they began. A separate thread checks the files every
// second, so that a blocked storage delays no connection.
#pragma once

#include <boost/asio/ssl/context.hpp>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "base/looks.h"
#include "base/time_source.h"

namespace thunderhead::gateway {

class TlsContexts {
 public:
  // Loads PEM files: the certificate chain, with the server's own certificate first, and the key.
  // Returns INVALID_ARGUMENT if the files cannot be read or do not match. `time` must outlive this
  // object.
  static absl::StatusOr<std::unique_ptr<TlsContexts>> Open(
      std::string certificate, std::string key, const base::TimeSource& time = base::SteadyTime());

  // Returns the TLS context with the newest files that could be loaded.
  std::shared_ptr<boost::asio::ssl::context> Current();

 private:
  struct State;

  TlsContexts(const std::shared_ptr<State>& state, const base::TimeSource& time);

  const std::shared_ptr<State> state_;
  const std::unique_ptr<base::Looks> looks_;
};

}  // namespace thunderhead::gateway
