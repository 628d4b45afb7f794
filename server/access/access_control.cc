#include "access/access_control.h"

#include <openssl/crypto.h>
#include <openssl/rand.h>

#include <chrono>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "access/rules.h"
#include "base/error_details.h"
#include "base/status.h"

namespace thunderhead::access {
namespace {

constexpr std::size_t kTokenBytes = 32;
constexpr std::chrono::seconds kKnownFor{1};

std::string RandomToken() {
  std::string bytes(kTokenBytes, '\0');
  const int made = RAND_bytes(reinterpret_cast<unsigned char*>(bytes.data()), kTokenBytes);
  THUNDERHEAD_CHECK(made == 1, "the system gives no random bytes");
  return absl::BytesToHexString(bytes);
}

absl::Status NotForRole(std::string_view method, const Identity& identity) {
  return base::WithDetails(
      absl::PermissionDeniedError(
          absl::StrCat(std::string(method), " is not for the role of ", NameOf(identity.role),
                       ", which your token has; ask the server's operator")),
      {.reason = "ROLE_MAY_NOT", .metadata = {{"role", NameOf(identity.role)}}});
}

}  // namespace

void Caller::Report(std::string_view act, const absl::Status& outcome) const {
  audit_->Write({identity_.name, NameOf(identity_.role), credentials_.peer, std::string(act)},
                outcome);
}

void Caller::ReportRefusal(std::string_view act, const absl::Status& outcome) const {
  if (absl::IsPermissionDenied(outcome) || absl::IsResourceExhausted(outcome) ||
      absl::IsNotFound(outcome)) {
    Report(act, outcome);
  }
}

absl::StatusOr<std::shared_ptr<const void>> Caller::TakeAnswer(std::size_t bytes) const {
  if (quotas_ == nullptr) return std::shared_ptr<const void>();
  return quotas_->TakeAnswer(identity_.name, bytes);
}

absl::StatusOr<std::shared_ptr<const void>> Caller::TakeUnread(std::size_t bytes) const {
  if (quotas_ == nullptr) return std::shared_ptr<const void>();
  return quotas_->TakeUnread(identity_.name, bytes);
}

absl::Status Caller::StillKnown(std::optional<std::chrono::steady_clock::time_point> at) const {
  // The authenticator is null if the caller is this process itself.
  if (authenticator_ == nullptr) return absl::OkStatus();
  const auto now = at.value_or(time_->Now());
  if (now < known_at_.load() + kKnownFor) return absl::OkStatus();
  absl::Status identified = Identified();
  if (identified.ok()) {
    known_at_ = now;
  } else {
    Report(method_, identified);
  }
  return identified;
}

absl::Status Caller::Identified() const {
  THUNDERHEAD_ASSIGN_OR_RETURN(const Identity identity, authenticator_->Identify(credentials_));
  if (identity.name == identity_.name && identity.role == identity_.role) return absl::OkStatus();
  return base::WithDetails(
      absl::UnauthenticatedError("the token now has another name or role; make the call again"),
      {.reason = "TOKEN_CHANGED"});
}

AccessControl::AccessControl(std::unique_ptr<Authenticator> authenticator,
                             std::shared_ptr<Audit> audit, const QuotaLimits& limits,
                             base::TrustedProxies proxies, const base::TimeSource& time)
    : authenticator_(std::move(authenticator)),
      audit_(std::move(audit)),
      quotas_(limits),
      wrong_tokens_(limits.wrong_tokens_per_second),
      proxies_(std::move(proxies)),
      time_(time),
      own_token_(RandomToken()) {}

absl::Status AccessControl::Check(std::string_view method, CallKind kind, Caller& caller) {
  const Identity& identity = caller.identity_;
  if (!MayCall(identity.role, method)) return NotForRole(method, identity);
  if (caller.authenticator_ == nullptr || identity.name.empty()) return absl::OkStatus();
  THUNDERHEAD_RETURN_IF_ERROR(quotas_.TakeRequest(identity.name, time_.Now()));
  caller.quotas_ = &quotas_;
  if (kind == CallKind::kUnary) return absl::OkStatus();
  THUNDERHEAD_ASSIGN_OR_RETURN(caller.place_, quotas_.TakeStream(identity.name));
  return absl::OkStatus();
}

absl::StatusOr<Identity> AccessControl::Identify(const Credentials& shown) {
  const auto now = time_.Now();
  THUNDERHEAD_RETURN_IF_ERROR(wrong_tokens_.MayShow(shown, now));
  absl::StatusOr<Identity> identity = authenticator_->Identify(shown);
  if (identity.ok()) {
    wrong_tokens_.WasRight(shown);
  } else if (absl::IsUnauthenticated(identity.status())) {
    wrong_tokens_.WasWrong(shown, now);
  }
  return identity;
}

absl::StatusOr<std::shared_ptr<const Caller>> AccessControl::Admit(std::string_view method,
                                                                   CallKind kind,
                                                                   Credentials credentials) {
  auto caller = std::make_shared<Caller>();
  caller->audit_ = audit_.get();
  caller->time_ = &time_;
  caller->credentials_ = std::move(credentials);
  caller->method_ = std::string(method);
  const Credentials& shown = caller->credentials_;
  absl::Status status;
  if (shown.token.size() == own_token_.size() &&
      CRYPTO_memcmp(shown.token.data(), own_token_.data(), own_token_.size()) == 0) {
    caller->identity_.role = Role::kOperator;
  } else {
    caller->authenticator_ = authenticator_.get();
    absl::StatusOr<Identity> identity = Identify(shown);
    status = identity.status();
    if (status.ok()) caller->identity_ = *std::move(identity);
  }
  const bool is_known = status.ok();
  if (is_known) status = Check(method, kind, *caller);
  if (status.ok()) return caller;
  audit_->Write({caller->identity_.name, is_known ? NameOf(caller->identity_.role) : "", shown.peer,
                 std::string(method)},
                status);
  return status;
}

void AccessControl::ReportBeforeCall(const std::string& peer, std::string_view act,
                                     const absl::Status& refusal) {
  audit_->Write({"", "", peer, std::string(act), /*before_call=*/true}, refusal);
}

}  // namespace thunderhead::access
