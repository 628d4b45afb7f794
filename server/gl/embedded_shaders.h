// All shader files of server/shaders, by their paths below that folder. The map is generated at
// build time.
#pragma once

#include <map>
#include <string_view>

namespace thunderhead::gl {

const std::map<std::string_view, std::string_view>& EmbeddedShaders();

}  // namespace thunderhead::gl
