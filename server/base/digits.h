// Texts of decimal digits only. In contrast, absl::SimpleAtoi also accepts a sign and white space.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace thunderhead::base {

// Returns whether the text consists of one or more decimal digits.
bool IsDigits(std::string_view text);

// Returns the number that the digits mean. Returns nothing if IsDigits is false, or if the number
// needs more than 64 bits. Leading zeros are accepted.
std::optional<std::uint64_t> ParseDigits(std::string_view text);

}  // namespace thunderhead::base
