// Texts inside a PNG (iTXt chunks), such as a description of the picture and of how it was made.
// Programs that display the picture skip these chunks.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::frame {

// Texts by keyword. A keyword has 1 to 79 ASCII characters. Texts are UTF-8.
using PngTexts = std::map<std::string, std::string>;

// Returns `png` with the texts added. EncodePng must have made `png`.
std::string WithTexts(const std::string& png, const PngTexts& texts);

// Returns true for bytes that begin with the PNG signature.
bool IsPng(const std::string& bytes);

// Checks that no chunk is cut short, except that the bytes may end within the pixel data. Before
// libpng reads a chunk, it allocates as much memory as the chunk's length says, up to 2 GiB.
// Returns INVALID_ARGUMENT if a chunk is cut short.
absl::Status CheckPngChunks(std::string_view png);

// Returns the texts in front of the pixel data of a PNG, which any program may have made. The
// bytes may end within the pixel data. Returns INVALID_ARGUMENT if the bytes are not a valid PNG.
absl::StatusOr<PngTexts> TextsOf(const std::string& png);

}  // namespace thunderhead::frame
