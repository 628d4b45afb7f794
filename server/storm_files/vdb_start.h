// Recognises OpenVDB files. They are not storm files, because they name neither their units nor
// which axis is up.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace thunderhead::storm_files {

// The first bytes of every OpenVDB file.
inline constexpr std::string_view kVdbStart{" BDV\0\0\0\0", 8};

inline bool BeginsLikeVdb(std::string_view start) { return start.starts_with(kVdbStart); }

// Returns the error for an OpenVDB file that is given as a storm.
absl::Status RefuseVdb(const std::string& path);

}  // namespace thunderhead::storm_files
