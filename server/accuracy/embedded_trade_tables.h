// Returns the tables in docs/accuracy as texts. The key is the name of the view: "orbit", "spotter"
// or "top-down". cmake/embed_texts.cmake builds the texts into the program.
#pragma once

#include <map>
#include <string_view>

namespace thunderhead::accuracy {

const std::map<std::string_view, std::string_view>& EmbeddedTradeTableTexts();

}  // namespace thunderhead::accuracy
