// Converts between the string views of Beast 1.74 and of the standard library.
#pragma once

#include <boost/beast/core/string.hpp>
#include <string_view>

namespace thunderhead::gateway {

inline std::string_view View(boost::beast::string_view text) { return {text.data(), text.size()}; }

inline boost::beast::string_view BeastView(std::string_view text) {
  return {text.data(), text.size()};
}

}  // namespace thunderhead::gateway
