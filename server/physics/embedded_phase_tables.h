// The texts of data/phase, built into the program by cmake/embed_texts.cmake, by table name.
#pragma once

#include <map>
#include <string_view>

namespace thunderhead::physics {

const std::map<std::string_view, std::string_view>& EmbeddedPhaseTableTexts();

}  // namespace thunderhead::physics
