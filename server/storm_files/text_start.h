// Splits the first bytes of a file into lines of numbers, by which formats recognise their texts.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace thunderhead::storm_files {

// Maximum number of grid points along an axis.
inline constexpr int kMostGridPoints = 1'000'000;

// A line among the first bytes of a file.
struct StartLine {
  std::string_view text;        // without the comment
  std::vector<double> numbers;  // the numbers with which the line begins
  bool only_numbers = false;
  bool is_cut = false;  // true if the line continues after the first bytes

  // Returns whether the line begins with three numbers of grid points.
  bool BeginsWithSize() const;

  // Returns whether the line consists of `count` numbers, as far as it is known.
  bool HasNumbers(std::size_t count) const;
};

// Returns the lines of the first bytes of a file, without blank lines. A character of `comments`
// begins a comment. Returns nothing if the file is no text.
std::vector<StartLine> FirstTextLines(std::string_view start, std::string_view comments);

}  // namespace thunderhead::storm_files
