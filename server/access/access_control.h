// Access control: every call passes through AccessControl::Admit. Admit identifies the caller, and
// checks whether the caller's role may make the call and whether the caller has reached a limit.
// Each refusal is written to the audit log. This code does not depend on HTTP or on the API's
// messages.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
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
  // Writes an act of the caller and its outcome to the audit log.
  void Report(std::string_view act, const absl::Status& outcome) const;
  // Writes `outcome` to the audit log if it is a refusal: PERMISSION_DENIED, RESOURCE_EXHAUSTED, or
  // NOT_FOUND, which is the error for a wrong key. Other outcomes are not written. By default, the
  // act is the name of the rpc.
  void ReportRefusal(const absl::Status& outcome) const { ReportRefusal(method_, outcome); }
  void ReportRefusal(std::string_view act, const absl::Status& outcome) const;
  // Reserves a place and memory for a finished response of `bytes` bytes that waits for this caller
  // to receive it. Both are released when the last copy of the result is destroyed. Returns null if
  // the caller is this process itself.
  absl::StatusOr<std::shared_ptr<const void>> TakeAnswer(std::size_t bytes) const;
  // Reserves memory for a stream's next message in the same way.
  absl::StatusOr<std::shared_ptr<const void>> TakeUnread(std::size_t bytes) const;
  // Checks the caller's token again, at most once a second. Returns UNAUTHENTICATED, and writes
  // this to the audit log, if the token has expired, was removed, or now has another name or role.
  absl::Status StillKnown(
      std::optional<std::chrono::steady_clock::time_point> at = std::nullopt) const;

 private:
  friend class AccessControl;

  absl::Status Identified() const;

  Identity identity_;
  Credentials credentials_;
  std::string method_;  // name of the rpc
  Authenticator* authenticator_ = nullptr;
  Audit* audit_ = nullptr;
  const base::TimeSource* time_ = &base::SteadyTime();
  Quotas* quotas_ = nullptr;  // null if no quotas apply to the caller
  std::shared_ptr<const void> place_;
  mutable std::atomic<std::chrono::steady_clock::time_point> known_at_ = {};
};

// The kind of a call: kUnary counts as a request only, kStream also as an open stream.
enum class CallKind { kUnary, kStream };

class AccessControl {
 public:
  // `time` must outlive the object. It is the clock for quotas and for repeated checks of
  // tokens.
  AccessControl(std::unique_ptr<Authenticator> authenticator, std::shared_ptr<Audit> audit,
                const QuotaLimits& limits, base::TrustedProxies proxies = {},
                const base::TimeSource& time = base::SteadyTime());

  // Admits a call, or returns UNAUTHENTICATED, PERMISSION_DENIED or RESOURCE_EXHAUSTED. The
  // returned Caller must not outlive this object.
  absl::StatusOr<std::shared_ptr<const Caller>> Admit(std::string_view method, CallKind kind,
                                                      Credentials credentials);

  // Writes to the audit log that the gateway refused a request before it became a call.
  void ReportBeforeCall(const std::string& peer, std::string_view act, const absl::Status& refusal);

  // Waits up to `time` until all lines of the audit log are written. Safe from any thread.
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
