// The texts of the files in data/phase by table name. cmake/embed_texts.cmake builds them into the
// program.
#pragma once

#include <map>
#include <string_view>

namespace thunderhead::physics {

const std::map<std::string_view, std::string_view>& EmbeddedPhaseTableTexts();

}  // namespace thunderhead::physics
