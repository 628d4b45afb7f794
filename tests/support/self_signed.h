// A self-signed certificate for localhost with its key, as PEM files.
#pragma once

#include <string>

namespace thunderhead::testing {

// Writes a new certificate with a new key. Each of the two files is replaced atomically. `serial`
// is the certificate's serial number.
void WriteSelfSigned(const std::string& certificate_path, const std::string& key_path, long serial);

}  // namespace thunderhead::testing
