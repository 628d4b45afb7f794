#include "base/patient_calls.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"

namespace thunderhead::base {
namespace {

constexpr std::chrono::seconds kRetryAfter{10};

absl::Status NoAnswer(const std::string& storage) {
  return WithDetails(
      absl::DeadlineExceededError(absl::StrCat(storage, ": its storage does not answer")),
      {.reason = "STORAGE_HANGS", .metadata = {{"file", storage}}, .retry_after = kRetryAfter});
}

}  // namespace

absl::Status PatientCalls::Run(const std::string& storage, const std::function<void()>& call) {
  {
    const std::lock_guard lock(mutex_);
    if (Hangs(storage)) return NoAnswer(storage);
  }
  LooseThread thread(absl::StrCat("a call to ", storage), call);
  if (thread.EndsWithin(patience_)) return absl::OkStatus();
  const std::lock_guard lock(mutex_);
  hanging_.emplace(storage, std::move(thread));
  return NoAnswer(storage);
}

bool PatientCalls::Hangs(const std::string& storage) {
  const auto [begin, end] = hanging_.equal_range(storage);
  for (auto call = begin; call != end;) {
    if (!call->second.EndsWithin(std::chrono::milliseconds(0))) return true;
    call = hanging_.erase(call);
  }
  return false;
}

}  // namespace thunderhead::base
