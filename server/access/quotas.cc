#include "access/quotas.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"

namespace thunderhead::access {
namespace {

// The retry delay for too many streams. It is short, because streams end one after another when
// viewers leave.
constexpr std::chrono::seconds kStreamRetry{10};

absl::Status TooMany(std::size_t maximum, const std::string& message, const char* reason,
                     const char* unit) {
  return base::WithDetails(absl::ResourceExhaustedError(message),
                           {.reason = reason,
                            .metadata = {{"maximum", absl::StrCat(maximum)}, {"unit", unit}},
                            .retry_after = kStreamRetry});
}

absl::Status TooManyStreams(std::size_t maximum, const char* whose) {
  return TooMany(maximum,
                 absl::StrCat(whose, " ", maximum,
                              " open calls, which is the maximum; end one, or try again later"),
                 "TOO_MANY_STREAMS", "streams");
}

absl::Status TooManyAnswers(std::size_t maximum, const char* whose) {
  return TooMany(
      maximum,
      absl::StrCat(
          whose, " ", maximum,
          " responses that were not read yet, which is the maximum; read one, or try again later"),
      "ANSWERS_NOT_TAKEN", "answers");
}

// Returns the error for a request that must wait for `wait`, or OK if `wait` is absent.
absl::Status TooManyRequests(double per_second, std::optional<std::chrono::milliseconds> wait) {
  if (!wait.has_value()) return absl::OkStatus();
  return base::WithDetails(
      absl::ResourceExhaustedError(
          absl::StrCat("more than ", per_second, " requests per second; send them more slowly")),
      {.reason = "TOO_MANY_REQUESTS",
       .metadata = {{"maximum", absl::StrCat(per_second)}, {"unit", "requests/s"}},
       .retry_after = std::max(std::chrono::milliseconds(100), *wait)});
}

}  // namespace

absl::Status RequestBudget::Take(Time now) {
  if (per_second_ <= 0.0) return absl::OkStatus();
  return TooManyRequests(per_second_, left_.Take(now));
}

absl::Status Quotas::TakeRequest(const std::string& identity, Time now) {
  const std::lock_guard lock(mutex_);
  return TooManyRequests(requests_.PerSecond(), requests_.Take(identity, now));
}

absl::StatusOr<std::shared_ptr<const void>> Quotas::TakeStream(const std::string& identity) {
  return Take(identity, streams_, TooManyStreams);
}

absl::StatusOr<std::shared_ptr<const void>> Quotas::TakeAnswer(const std::string& identity) {
  return Take(identity, answers_, TooManyAnswers);
}

absl::StatusOr<std::shared_ptr<const void>> Quotas::Take(const std::string& identity, Count& count,
                                                         Refusal refusal) {
  const std::lock_guard lock(mutex_);
  if (count.all >= limits_.max_streams) return refusal(limits_.max_streams, "the server has");
  std::size_t& own = count.by_identity[identity];
  if (own >= limits_.max_streams_per_identity) {
    return refusal(limits_.max_streams_per_identity, "you have");
  }
  ++own;
  ++count.all;
  return std::shared_ptr<const void>(
      this, [this, identity, &count](const void*) { GiveBack(identity, count); });
}

void Quotas::GiveBack(const std::string& identity, Count& count) {
  const std::lock_guard lock(mutex_);
  --count.all;
  const auto own = count.by_identity.find(identity);
  if (--own->second == 0) count.by_identity.erase(own);
}

}  // namespace thunderhead::access
