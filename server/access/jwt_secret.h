// Distinguishes a secret for HS256 from a key in another form. If a public key were taken for the
// secret, everyone who knows that key could sign tokens.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace thunderhead::access {

// Returns OK if `text` may be a secret of HS256: one line of printable text (UTF-8) of 32 to 256
// bytes that is no key in another form. Every public RSA key of at least 2048 bits is longer as
// text. Otherwise returns INVALID_ARGUMENT, which says what the text seems to be and how to convert
// it.
absl::Status CheckSecret(const std::string& text);

}  // namespace thunderhead::access
