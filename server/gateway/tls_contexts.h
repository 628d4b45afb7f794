// The certificate and key of connections by TLS, loaded again when their files change: connections
// that are open keep what they began with. Runs on one thread.
#pragma once

#include <boost/asio/ssl/context.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "base/file_stamp.h"

namespace thunderhead::gateway {

class TlsContexts {
 public:
  // PEM files: the chain, the server's own certificate first, and its key. INVALID_ARGUMENT if they
  // cannot be read or do not belong together.
  static absl::StatusOr<TlsContexts> Open(std::string certificate, std::string key);

  // The context of the newest files that could be loaded.
  std::shared_ptr<boost::asio::ssl::context> Current();

 private:
  using Stamps = std::pair<std::optional<base::FileStamp>, std::optional<base::FileStamp>>;

  TlsContexts(std::string certificate, std::string key)
      : certificate_(std::move(certificate)), key_(std::move(key)) {}
  Stamps Look() const;
  absl::Status Load();

  std::string certificate_;
  std::string key_;
  Stamps stamps_;
  std::shared_ptr<boost::asio::ssl::context> newest_;
};

}  // namespace thunderhead::gateway
