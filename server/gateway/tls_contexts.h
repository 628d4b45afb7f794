// The certificate and key of TLS connections, which are loaded again when their files change. Open
// connections keep those that they began with. A separate thread checks the files every second, so
// that a hanging storage delays no connection.
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
  // Opens PEM files: the chain, with the server's own certificate first, and its key. Returns
  // INVALID_ARGUMENT if they cannot be read or do not match. `time` must outlive this object.
  static absl::StatusOr<std::unique_ptr<TlsContexts>> Open(
      std::string certificate, std::string key, const base::TimeSource& time = base::SteadyTime());

  // Returns the context of the newest files that could be loaded.
  std::shared_ptr<boost::asio::ssl::context> Current();

 private:
  struct State;

  TlsContexts(const std::shared_ptr<State>& state, const base::TimeSource& time);

  const std::shared_ptr<State> state_;
  const std::unique_ptr<base::Looks> looks_;
};

}  // namespace thunderhead::gateway
