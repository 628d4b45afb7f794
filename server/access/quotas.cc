#include "access/quotas.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"

namespace thunderhead::access {
namespace {

// Identities whose requests are counted; beyond these, those that rest are forgotten.
constexpr std::size_t kMaxBudgets = 4096;

// People leave one after another.
constexpr std::chrono::seconds kStreamRetry{10};

absl::Status TooManyStreams(std::size_t maximum, const char* whose) {
  return base::WithDetails(
      absl::ResourceExhaustedError(absl::StrCat(whose, " ", maximum,
                                                " open calls, which is the maximum; end one, or "
                                                "try again later")),
      {.reason = "TOO_MANY_STREAMS",
       .metadata = {{"maximum", absl::StrCat(maximum)}, {"unit", "streams"}},
       .retry_after = kStreamRetry});
}

absl::Status TooManyAnswers(std::size_t maximum, const char* whose) {
  return base::WithDetails(
      absl::ResourceExhaustedError(absl::StrCat(whose, " ", maximum,
                                                " answers that were not taken yet, which is the "
                                                "maximum; take one, or try again later")),
      {.reason = "ANSWERS_NOT_TAKEN",
       .metadata = {{"maximum", absl::StrCat(maximum)}, {"unit", "answers"}},
       .retry_after = kStreamRetry});
}

double Seconds(std::chrono::steady_clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

double RequestBudget::LeftAt(double per_second, Time now) const {
  return std::min(kBurst_s * per_second, left_ + per_second * Seconds(now - at_));
}

bool RequestBudget::IsFull(double per_second, Time now) const {
  return LeftAt(per_second, now) >= kBurst_s * per_second;
}

absl::Status RequestBudget::Take(double per_second, Time now) {
  if (per_second <= 0.0) return absl::OkStatus();
  left_ = LeftAt(per_second, now);
  at_ = now;
  if (left_ >= 1.0) {
    left_ -= 1.0;
    return absl::OkStatus();
  }
  const std::chrono::duration<double, std::milli> wait_ms(1000.0 * (1.0 - left_) / per_second);
  return base::WithDetails(
      absl::ResourceExhaustedError(
          absl::StrCat("more than ", per_second, " requests a second; send them more slowly")),
      {.reason = "TOO_MANY_REQUESTS",
       .metadata = {{"maximum", absl::StrCat(per_second)}, {"unit", "requests/s"}},
       .retry_after = std::max(std::chrono::milliseconds(100),
                               std::chrono::ceil<std::chrono::milliseconds>(wait_ms))});
}

absl::Status Quotas::TakeRequest(const std::string& identity, Time now) {
  const double per_second = limits_.requests_per_second;
  if (per_second <= 0.0) return absl::OkStatus();
  const std::lock_guard lock(mutex_);
  auto budget = budgets_.find(identity);
  if (budget == budgets_.end()) {
    if (budgets_.size() >= kMaxBudgets) {
      std::erase_if(budgets_,
                    [&](const auto& entry) { return entry.second.IsFull(per_second, now); });
    }
    budget = budgets_.emplace(identity, RequestBudget(per_second, now)).first;
  }
  return budget->second.Take(per_second, now);
}

absl::StatusOr<std::shared_ptr<const void>> Quotas::TakeStream(const std::string& identity) {
  return Take(identity, streams_, TooManyStreams);
}

absl::StatusOr<std::shared_ptr<const void>> Quotas::TakeAnswer(const std::string& identity) {
  return Take(identity, answers_, TooManyAnswers);
}

absl::StatusOr<std::shared_ptr<const void>> Quotas::Take(const std::string& identity, Count& count,
                                                         TooMany too_many) {
  const std::lock_guard lock(mutex_);
  if (count.all >= limits_.max_streams) return too_many(limits_.max_streams, "the server has");
  std::size_t& own = count.by_identity[identity];
  if (own >= limits_.max_streams_per_identity) {
    return too_many(limits_.max_streams_per_identity, "you have");
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
