#include "access/quotas.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/status.h"

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

absl::Status TooMuchUnread(std::size_t maximum_bytes, const char* whose) {
  return TooMany(maximum_bytes,
                 absl::StrCat(whose, " too many bytes of messages that were not read yet (at most ",
                              maximum_bytes, " bytes of memory); read one, or try again later"),
                 "ANSWERS_NOT_TAKEN", "bytes");
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

absl::StatusOr<std::shared_ptr<const void>> Quotas::TakeAnswer(const std::string& identity,
                                                               std::size_t bytes) {
  struct Place {
    std::shared_ptr<const void> answer;
    std::shared_ptr<const void> memory;
  };
  auto place = std::make_shared<Place>();
  THUNDERHEAD_ASSIGN_OR_RETURN(place->answer, Take(identity, answers_, TooManyAnswers));
  THUNDERHEAD_ASSIGN_OR_RETURN(place->memory, TakeUnread(identity, bytes));
  return place;
}

absl::StatusOr<std::shared_ptr<const void>> Quotas::TakeUnread(const std::string& identity,
                                                               std::size_t bytes) {
  if (bytes <= kSmallMessage_bytes) return std::shared_ptr<const void>();
  const std::lock_guard lock(mutex_);
  const auto found = unread_bytes_.by_identity.find(identity);
  const bool is_first = found == unread_bytes_.by_identity.end();
  if (!is_first && found->second + bytes > limits_.max_unread_bytes_per_identity) {
    return TooMuchUnread(limits_.max_unread_bytes_per_identity, "you have");
  }
  if (unread_bytes_.all + (is_first ? 1 : bytes) > limits_.max_unread_bytes) {
    return TooMuchUnread(limits_.max_unread_bytes, "the server has");
  }
  return Hold(identity, unread_bytes_, bytes);
}

absl::StatusOr<std::shared_ptr<const void>> Quotas::Take(const std::string& identity, Count& count,
                                                         Refusal refusal) {
  const std::lock_guard lock(mutex_);
  if (count.all >= limits_.max_streams) return refusal(limits_.max_streams, "the server has");
  const auto own = count.by_identity.find(identity);
  if (own != count.by_identity.end() && own->second >= limits_.max_streams_per_identity) {
    return refusal(limits_.max_streams_per_identity, "you have");
  }
  return Hold(identity, count, 1);
}

std::shared_ptr<const void> Quotas::Hold(const std::string& identity, Count& count,
                                         std::size_t amount) {
  count.by_identity[identity] += amount;
  count.all += amount;
  return std::shared_ptr<const void>(
      this, [this, identity, &count, amount](const void*) { GiveBack(identity, count, amount); });
}

void Quotas::GiveBack(const std::string& identity, Count& count, std::size_t amount) {
  const std::lock_guard lock(mutex_);
  count.all -= amount;
  const auto own = count.by_identity.find(identity);
  own->second -= amount;
  if (own->second == 0) count.by_identity.erase(own);
}

}  // namespace thunderhead::access
