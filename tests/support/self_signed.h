// A self-signed certificate for localhost with its key, as PEM files.
#pragma once

#include <string>

namespace thunderhead::testing {

// Replaces both files, each atomically. Each certificate has a new key and the given serial number.
void WriteSelfSigned(const std::string& certificate_path, const std::string& key_path, long serial);

}  // namespace thunderhead::testing
