// The certificate and key of connections by TLS, loaded again when their files change: connections
// that are open keep what they began with. The files are looked at every second, by a thread of its
// own: a storage that hangs holds up nobody.
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
  // PEM files: the chain, the server's own certificate first, and its key. INVALID_ARGUMENT if they
  // cannot be read or do not belong together. `time` must outlive it.
  static absl::StatusOr<std::unique_ptr<TlsContexts>> Open(
      std::string certificate, std::string key, const base::TimeSource& time = base::SteadyTime());

  // The context of the newest files that could be loaded.
  std::shared_ptr<boost::asio::ssl::context> Current();

 private:
  struct State;

  TlsContexts(const std::shared_ptr<State>& state, const base::TimeSource& time);

  const std::shared_ptr<State> state_;
  const std::unique_ptr<base::Looks> looks_;
};

}  // namespace thunderhead::gateway
