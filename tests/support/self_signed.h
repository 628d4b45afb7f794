// A certificate for localhost that signs itself, with its key, as PEM files.
#pragma once

#include <string>

namespace thunderhead::testing {

// Writes both, each in one step, over what was there. Every one has a key and a serial number of
// its own.
void WriteSelfSigned(const std::string& certificate_path, const std::string& key_path, long serial);

}  // namespace thunderhead::testing
