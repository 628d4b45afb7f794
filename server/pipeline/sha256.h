// SHA-256, in lower-case hexadecimal as sha256sum prints it.
#pragma once

#include <stop_token>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace thunderhead::pipeline {

std::string Sha256(std::string_view bytes);

// Returns UNAVAILABLE if the file cannot be read, and CANCELLED if `stop` is requested meanwhile.
absl::StatusOr<std::string> Sha256OfFile(const std::string& path, const std::stop_token& stop = {});

}  // namespace thunderhead::pipeline
