// The texts of docs/accuracy by view: "orbit", "spotter", "top-down". cmake/embed_texts.cmake
// builds them into the program.
#pragma once

#include <map>
#include <string_view>

namespace thunderhead::accuracy {

const std::map<std::string_view, std::string_view>& EmbeddedTradeTableTexts();

}  // namespace thunderhead::accuracy
