// Tells the secret of HS256 from a key in another form. A public key that were taken for the secret
// would let everyone who knows it sign tokens.
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
