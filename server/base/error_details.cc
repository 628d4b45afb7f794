#include "base/error_details.h"

#include <cstdint>
#include <utility>

#include "absl/strings/cord.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

namespace thunderhead::base {
namespace {

constexpr char kReason[] = "thunderhead/reason";
constexpr char kField[] = "thunderhead/field";
constexpr char kDescription[] = "thunderhead/description";
constexpr char kRetryAfterMs[] = "thunderhead/retry_after_ms";
constexpr char kPermanent[] = "thunderhead/permanent";
constexpr char kMetadata[] = "thunderhead/metadata/";  // followed by the key

// The retry delay for clients of a server that is stopping. A restart takes about this time.
constexpr std::chrono::seconds kRestart{5};

void AddPayload(absl::Status& status, const std::string& name, const std::string& text) {
  if (text.empty() || status.GetPayload(name).has_value()) return;
  status.SetPayload(name, absl::Cord(text));
}

std::string PayloadOf(const absl::Status& status, const char* name) {
  const auto payload = status.GetPayload(name);
  return payload.has_value() ? std::string(*payload) : "";
}

}  // namespace

absl::Status WithDetails(absl::Status status, const ErrorDetails& details) {
  AddPayload(status, kReason, details.reason);
  // A description belongs to its field, so it is not added to a status that has another field.
  if (!status.GetPayload(kField).has_value()) {
    AddPayload(status, kDescription, details.description);
  }
  AddPayload(status, kField, details.field);
  for (const auto& [key, value] : details.metadata) {
    AddPayload(status, absl::StrCat(kMetadata, key), value);
  }
  if (details.retry_after.has_value()) {
    AddPayload(status, kRetryAfterMs, absl::StrCat(details.retry_after->count()));
  }
  if (details.permanent) AddPayload(status, kPermanent, "true");
  return status;
}

ErrorDetails DetailsOf(const absl::Status& status) {
  ErrorDetails details;
  details.reason = PayloadOf(status, kReason);
  details.field = PayloadOf(status, kField);
  details.description = PayloadOf(status, kDescription);
  status.ForEachPayload([&details](absl::string_view name, const absl::Cord& text) {
    if (!absl::ConsumePrefix(&name, kMetadata)) return;
    details.metadata[std::string(name)] = std::string(text);
  });
  std::int64_t retry_after_ms = 0;
  if (absl::SimpleAtoi(PayloadOf(status, kRetryAfterMs), &retry_after_ms)) {
    details.retry_after = std::chrono::milliseconds(retry_after_ms);
  }
  details.permanent = status.GetPayload(kPermanent).has_value();
  return details;
}

absl::Status InvalidField(const std::string& field, const std::string& description,
                          const std::string& reason,
                          const std::map<std::string, std::string>& metadata) {
  return WithDetails(
      absl::InvalidArgumentError(absl::StrCat(field, " ", description)),
      {.reason = reason, .field = field, .description = description, .metadata = metadata});
}

absl::Status ShuttingDown() {
  return WithDetails(absl::UnavailableError("the server is shutting down"),
                     {.reason = "SHUTTING_DOWN", .retry_after = kRestart});
}

absl::Status TooManyConnections() {
  return WithDetails(
      absl::ResourceExhaustedError("there are too many connections; close one, or try again later"),
      {.reason = "TOO_MANY_CONNECTIONS"});
}

absl::Status TooManyHandshakes() {
  return WithDetails(
      absl::ResourceExhaustedError("your address starts too many TLS connections per second; keep "
                                   "connections open, or try again later"),
      {.reason = "TOO_MANY_HANDSHAKES"});
}

absl::Status TooManyCalls() {
  return WithDetails(
      absl::ResourceExhaustedError("your address begins too many calls per second; make fewer "
                                   "calls, or try again later"),
      {.reason = "TOO_MANY_CALLS"});
}

}  // namespace thunderhead::base
