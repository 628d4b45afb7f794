// The one place where calls enter: who calls, whether their role may, and whether they already have
// as much as one may have. Writes each refusal to the audit. Knows no HTTP and no messages.
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

// Somebody whose call was let in. While it stays open, this counts as theirs.
class Caller {
 public:
  const Identity& identity() const { return identity_; }
  // A privileged act of theirs, or a refusal, for the audit.
  void Report(std::string_view act, const absl::Status& outcome) const;
  // Writes a refusal to the audit: PERMISSION_DENIED, RESOURCE_EXHAUSTED, or NOT_FOUND, which a
  // wrong key gets. Other outcomes are not written. `act` is by default the rpc.
  void ReportRefusal(const absl::Status& outcome) const { ReportRefusal(method_, outcome); }
  void ReportRefusal(std::string_view act, const absl::Status& outcome) const;
  // The place of an answer of theirs that is ready, until they have taken it; null for this process
  // itself.
  absl::StatusOr<std::shared_ptr<const void>> TakeAnswer() const;
  // UNAUTHENTICATED, which is written to the audit, once the token has expired or was taken away;
  // looks once a second at most.
  absl::Status StillKnown(
      std::optional<std::chrono::steady_clock::time_point> at = std::nullopt) const;

 private:
  friend class Door;

  absl::Status Identified() const;

  Identity identity_;
  Credentials credentials_;
  std::string method_;  // the rpc
  Authenticator* authenticator_ = nullptr;
  Audit* audit_ = nullptr;
  const base::TimeSource* time_ = &base::SteadyTime();
  Quotas* quotas_ = nullptr;  // null: they have none
  std::shared_ptr<const void> place_;
  mutable std::atomic<std::chrono::steady_clock::time_point> known_at_ = {};
};

// How a call counts.
enum class CallKind { kUnary, kStream };

class Door {
 public:
  // `time` must outlive the door; quotas and tokens that are looked at again go by it.
  Door(std::unique_ptr<Authenticator> authenticator, std::shared_ptr<Audit> audit,
       const QuotaLimits& limits, base::TrustedProxies proxies = {},
       const base::TimeSource& time = base::SteadyTime());

  // UNAUTHENTICATED, PERMISSION_DENIED or RESOURCE_EXHAUSTED. The caller must not outlive this.
  absl::StatusOr<std::shared_ptr<const Caller>> Admit(std::string_view method, CallKind kind,
                                                      Credentials credentials);

  // A refusal of the gateway before there was a call, for the audit.
  void ReportBeforeCall(const std::string& peer, std::string_view act, const absl::Status& refusal);

  // Waits at most that long until the audit is written; from any thread.
  void FlushAudit(std::chrono::milliseconds time) const { audit_->Flush(time); }

  // A token of this process' own, with which it calls itself as an operator.
  const std::string& OwnToken() const { return own_token_; }
  const QuotaLimits& limits() const { return quotas_.limits(); }
  // Who may say for whom they ask.
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
