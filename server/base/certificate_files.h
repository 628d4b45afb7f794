// The PEM files of a TLS certificate and its key. They are read again when they change. A separate
// thread checks them every second, so that a blocked storage delays no connection.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "base/storage_checks.h"
#include "base/time_source.h"

namespace thunderhead::base {

// The paths of the two files. If both are empty, TLS is off.
struct TlsFiles {
  std::string certificate;
  std::string key;
};

// The contents of the two files.
struct CertificatePem {
  std::string certificate;  // certificate chain, with the server's own certificate first
  std::string key;
};

class CertificateFiles {
 public:
  // A function that begins to use the contents `pem`. It returns INVALID_ARGUMENT if they cannot be
  // used; the previous contents then stay in use. It must own everything that it uses, because a
  // check that hangs can outlive this object.
  using Take = std::function<absl::Status(const CertificatePem& pem)>;

  // Reads the files and passes them to `take`, and does so again whenever a file has changed.
  // Returns INVALID_ARGUMENT if a file cannot be read, and the error of the first `take`. Later
  // errors are logged. `time` must outlive this object.
  static absl::StatusOr<std::unique_ptr<CertificateFiles>> Open(
      const TlsFiles& files, Take take, const TimeSource& time = SteadyTime());

 private:
  struct State;

  CertificateFiles(const std::shared_ptr<State>& state, const TimeSource& time);

  const std::unique_ptr<StorageChecks> checks_;
};

// Returns INVALID_ARGUMENT, which says that the file at `path` cannot be used as the `what` of TLS,
// because of `why`.
absl::Status CannotUseForTls(const std::string& what, const std::string& path,
                             const std::string& why);

}  // namespace thunderhead::base
