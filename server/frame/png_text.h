// Texts inside a PNG (iTXt chunks), such as what the picture shows and how it was made. Every
// viewer of pictures skips them.
#pragma once

#include <map>
#include <string>

#include "absl/status/statusor.h"

namespace thunderhead::frame {

// By keyword: 1 to 79 ASCII characters. Texts are UTF-8.
using PngTexts = std::map<std::string, std::string>;

// The PNG with the texts added, which EncodePng made.
std::string WithTexts(const std::string& png, const PngTexts& texts);

// True for bytes that begin as every PNG does.
bool IsPng(const std::string& bytes);

// The texts before the pixels of a PNG of any program. INVALID_ARGUMENT if it is not one, or
// broken.
absl::StatusOr<PngTexts> TextsOf(const std::string& png);

}  // namespace thunderhead::frame
