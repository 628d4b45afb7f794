#include "base/certificate_files.h"

#include <chrono>
#include <cstddef>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/file_stamp.h"
#include "base/named_file.h"
#include "base/status.h"
#include "spdlog/spdlog.h"

namespace thunderhead::base {
namespace {

constexpr std::chrono::seconds kPause{1};
// Maximum size of each file. Clients do not accept chains of certificates that are longer than
// this.
constexpr std::size_t kMost_bytes = 1 << 20;

absl::StatusOr<std::string> Read(const std::string& what, const std::string& path) {
  absl::StatusOr<std::string> bytes = ReadRegularFile(path, kMost_bytes);
  if (bytes.ok()) return bytes;
  return CannotUseForTls(what, path, std::string(bytes.status().message()));
}

}  // namespace

absl::Status CannotUseForTls(const std::string& what, const std::string& path,
                             const std::string& why) {
  return absl::InvalidArgumentError(
      absl::StrCat("cannot use ", path, " as the ", what, " of TLS: ", why,
                   "; it must be a PEM file, and the certificate must belong to the key"));
}

// The state of the checks. After Open, only the thread that checks the files uses it.
struct CertificateFiles::State {
  using Stamps = std::pair<std::optional<FileStamp>, std::optional<FileStamp>>;

  Stamps StampsNow() const { return {StampOf(files.certificate), StampOf(files.key)}; }

  absl::Status Load() const {
    CertificatePem pem;
    THUNDERHEAD_ASSIGN_OR_RETURN(pem.certificate, Read("certificate", files.certificate));
    THUNDERHEAD_ASSIGN_OR_RETURN(pem.key, Read("key", files.key));
    return take(pem);
  }

  void Look() {
    // The two files may be replaced one after the other. Until they match, the old contents stay in
    // use.
    const Stamps now = StampsNow();
    if (now == stamps) return;
    stamps = now;
    const absl::Status loaded = Load();
    if (loaded.ok()) {
      spdlog::info("{} has changed and was loaded", files.certificate);
    } else {
      spdlog::warn("TLS continues with the former certificate: {}", std::string(loaded.message()));
    }
  }

  const TlsFiles files;
  const Take take;
  Stamps stamps;
};

absl::StatusOr<std::unique_ptr<CertificateFiles>> CertificateFiles::Open(const TlsFiles& files,
                                                                         Take take,
                                                                         const TimeSource& time) {
  const std::shared_ptr<State> state(new State{files, std::move(take), {}});
  state->stamps = state->StampsNow();
  THUNDERHEAD_RETURN_IF_ERROR(state->Load());
  return std::unique_ptr<CertificateFiles>(new CertificateFiles(state, time));
}

CertificateFiles::CertificateFiles(const std::shared_ptr<State>& state, const TimeSource& time)
    : checks_(StorageChecks::Every(
          kPause, state->files.certificate, [state] { state->Look(); }, time)) {}

}  // namespace thunderhead::base
