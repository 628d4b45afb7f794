// Access control: the single place where calls enter. It checks who calls, whether their role may,
// and whether they have reached their limits. It writes each refusal to the audit. It does not
// depend on HTTP or on the API's messages.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "access/audit.h"
#include "access/authenticator.h"
#include "access/quotas.h"
#include "access/wrong_tokens.h"
#include "base/time_source.h"
#include "base/trusted_proxies.h"

namespace thunderhead::access {

// A caller whose call was admitted. A call that stays open counts towards the caller's limit while
// this object lives.
class Caller {
 public:
  const Identity& identity() const { return identity_; }
  // Writes a privileged act of the caller, or a refusal, to the audit.
  void Report(std::string_view act, const absl::Status& outcome) const;
  // Writes a refusal to the audit: PERMISSION_DENIED, RESOURCE_EXHAUSTED, or NOT_FOUND, which is
  // the error for a wrong key. Other outcomes are not written. `act` is by default the rpc.
  void ReportRefusal(const absl::Status& outcome) const { ReportRefusal(method_, outcome); }
  void ReportRefusal(std::string_view act, const absl::Status& outcome) const;
  // Reserves a place for an answer to this caller that is ready, until the caller has taken it.
  // Returns null for this process itself.
  absl::StatusOr<std::shared_ptr<const void>> TakeAnswer() const;
  // Checks the caller's token again, at most once a second. Returns UNAUTHENTICATED, and writes it
  // to the audit, if the token has expired or was removed.
  absl::Status StillKnown(
      std::optional<std::chrono::steady_clock::time_point> at = std::nullopt) const;

 private:
  friend class Door;

  absl::Status Identified() const;

  Identity identity_;
  Credentials credentials_;
  std::string method_;  // name of the rpc
  Authenticator* authenticator_ = nullptr;
  Audit* audit_ = nullptr;
  const base::TimeSource* time_ = &base::SteadyTime();
  Quotas* quotas_ = nullptr;  // null: no quotas apply
  std::shared_ptr<const void> place_;
  mutable std::atomic<std::chrono::steady_clock::time_point> known_at_ = {};
};

// Whether a call counts as a request only, or also as an open stream.
enum class CallKind { kUnary, kStream };

class Door {
 public:
  // `time` must outlive the door. It measures quotas and when tokens are checked again.
  Door(std::unique_ptr<Authenticator> authenticator, std::shared_ptr<Audit> audit,
       const QuotaLimits& limits, base::TrustedProxies proxies = {},
       const base::TimeSource& time = base::SteadyTime());

  // Admits a call, or returns UNAUTHENTICATED, PERMISSION_DENIED or RESOURCE_EXHAUSTED. The caller
  // must not outlive this object.
  absl::StatusOr<std::shared_ptr<const Caller>> Admit(std::string_view method, CallKind kind,
                                                      Credentials credentials);

  // Writes to the audit that the gateway refused a request before there was a call.
  void ReportBeforeCall(const std::string& peer, std::string_view act, const absl::Status& refusal);

  // Waits up to `time` until the audit is written. Safe from any thread.
  void FlushAudit(std::chrono::milliseconds time) const { audit_->Flush(time); }

  // Returns the token with which this process calls itself as an operator.
  const std::string& OwnToken() const { return own_token_; }
  const QuotaLimits& limits() const { return quotas_.limits(); }
  // Returns the proxies that may report their clients' addresses.
  const base::TrustedProxies& Proxies() const { return proxies_; }

 private:
  absl::Status Check(std::string_view method, CallKind kind, Caller& caller);
  absl::StatusOr<Identity> Identify(const Credentials& shown);

  const std::unique_ptr<Authenticator> authenticator_;
  const std::shared_ptr<Audit> audit_;
  Quotas quotas_;
  WrongTokens wrong_tokens_;
  const base::TrustedProxies proxies_;
  const base::TimeSource& time_;
  const std::string own_token_;
};

}  // namespace thunderhead::access
