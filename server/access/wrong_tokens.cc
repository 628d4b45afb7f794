#include "access/wrong_tokens.h"

#include <openssl/sha.h>

#include "base/client_network.h"
#include "base/error_details.h"

namespace thunderhead::access {
namespace {

// Maximum number of tokens that are remembered.
constexpr std::size_t kMax = 4096;

std::string DigestOf(const std::string& token) {
  std::string digest(SHA256_DIGEST_LENGTH, '\0');
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(),
         reinterpret_cast<unsigned char*>(digest.data()));
  return digest;
}

}  // namespace

absl::Status WrongTokens::MayShow(const Credentials& shown, Time now) {
  if (!Counts(shown)) return absl::OkStatus();
  const std::lock_guard lock(mutex_);
  if (left_.HasAny(base::NetworkOf(shown.peer), now)) return absl::OkStatus();
  if (right_.contains(DigestOf(shown.token))) return absl::OkStatus();
  return base::WithDetails(
      absl::ResourceExhaustedError(
          "too many wrong tokens came from your address; try again in a few seconds"),
      {.reason = "TOO_MANY_WRONG_TOKENS", .retry_after = std::chrono::seconds(2)});
}

void WrongTokens::WasRight(const Credentials& shown) {
  if (!Counts(shown)) return;
  std::string digest = DigestOf(shown.token);
  const std::lock_guard lock(mutex_);
  if (right_.size() >= kMax) right_.clear();
  right_.insert(std::move(digest));
}

void WrongTokens::WasWrong(const Credentials& shown, Time now) {
  if (!Counts(shown)) return;
  const std::lock_guard lock(mutex_);
  // A token that was valid before and is no longer valid must be treated like any other wrong
  // token.
  right_.erase(DigestOf(shown.token));
  (void)left_.Take(base::NetworkOf(shown.peer), now);
}

}  // namespace thunderhead::access
