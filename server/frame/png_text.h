// Texts inside a PNG (iTXt chunks), such as a description of the picture and of how it was made.
// Programs that display the picture skip these chunks.
#pragma once

#include <map>
#include <string>

#include "absl/status/statusor.h"

namespace thunderhead::frame {

// Texts by keyword. A keyword has 1 to 79 ASCII characters. Texts are UTF-8.
using PngTexts = std::map<std::string, std::string>;

// Returns `png` with the texts added. EncodePng must have made `png`.
std::string WithTexts(const std::string& png, const PngTexts& texts);

// Returns true for bytes that begin with the PNG signature.
bool IsPng(const std::string& bytes);

// Returns the texts in front of the pixel data of a PNG, which any program may have made. Returns
// INVALID_ARGUMENT if the bytes are not a valid PNG.
absl::StatusOr<PngTexts> TextsOf(const std::string& png);

}  // namespace thunderhead::frame
