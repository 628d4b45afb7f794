#include "gateway/tls_contexts.h"

#include <chrono>
#include <mutex>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/file_stamp.h"
#include "base/status.h"
#include "spdlog/spdlog.h"

namespace thunderhead::gateway {
namespace {

namespace ssl = boost::asio::ssl;
using boost::system::error_code;

constexpr std::chrono::seconds kPause{1};

absl::Status CannotLoad(const std::string& what, const std::string& path, const error_code& error) {
  return absl::InvalidArgumentError(
      absl::StrCat("cannot use ", path, " as the ", what, " of TLS: ", error.message(),
                   "; it must be a PEM file, and the certificate must belong to the key"));
}

}  // namespace

// The state that the object and its checking thread share. Only the checking thread uses it, except
// for `newest`.
struct TlsContexts::State {
  using Stamps = std::pair<std::optional<base::FileStamp>, std::optional<base::FileStamp>>;

  Stamps StampsNow() const { return {base::StampOf(certificate), base::StampOf(key)}; }
  absl::Status Load();
  void Look();

  const std::string certificate;
  const std::string key;
  Stamps stamps;
  std::mutex mutex;
  std::shared_ptr<ssl::context> newest;
};

absl::StatusOr<std::unique_ptr<TlsContexts>> TlsContexts::Open(std::string certificate,
                                                               std::string key,
                                                               const base::TimeSource& time) {
  std::shared_ptr<State> state(
      new State{.certificate = std::move(certificate), .key = std::move(key)});
  state->stamps = state->StampsNow();
  THUNDERHEAD_RETURN_IF_ERROR(state->Load());
  return std::unique_ptr<TlsContexts>(new TlsContexts(state, time));
}

TlsContexts::TlsContexts(const std::shared_ptr<State>& state, const base::TimeSource& time)
    : state_(state),
      looks_(base::Looks::Every(
          kPause, state->certificate, [state] { state->Look(); }, time)) {}

absl::Status TlsContexts::State::Load() {
  auto context = std::make_shared<ssl::context>(ssl::context::tls_server);
  error_code error;
  context->set_options(ssl::context::default_workarounds | ssl::context::no_tlsv1 |
                           ssl::context::no_tlsv1_1 | ssl::context::no_compression,
                       error);
  context->use_certificate_chain_file(certificate, error);
  if (error) return CannotLoad("certificate", certificate, error);
  // This call fails if the key does not belong to the certificate.
  context->use_private_key_file(key, ssl::context::pem, error);
  if (error) return CannotLoad("key", key, error);
  const std::lock_guard lock(mutex);
  newest = std::move(context);
  return absl::OkStatus();
}

void TlsContexts::State::Look() {
  // The two files may be replaced one after the other. Until they match, the old contexts stay in
  // use.
  const Stamps now = StampsNow();
  if (now == stamps) return;
  stamps = now;
  const absl::Status loaded = Load();
  if (loaded.ok()) {
    spdlog::info("{} has changed and was loaded", certificate);
  } else {
    spdlog::warn("TLS continues with the former certificate: {}", std::string(loaded.message()));
  }
}

std::shared_ptr<ssl::context> TlsContexts::Current() {
  const std::lock_guard lock(state_->mutex);
  return state_->newest;
}

}  // namespace thunderhead::gateway
