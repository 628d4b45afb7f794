// The texts of docs/accuracy, built into the program by cmake/embed_texts.cmake, by view: "orbit",
// "spotter", "top-down".
#pragma once

#include <map>
#include <string_view>

namespace thunderhead::accuracy {

const std::map<std::string_view, std::string_view>& EmbeddedTradeTableTexts();

}  // namespace thunderhead::accuracy
