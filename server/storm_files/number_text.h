// Reads texts of numbers, such as Fortran programs write: numbers separated by blanks, tabs or
// commas.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "base/byte_source.h"

namespace thunderhead::storm_files {

// Returns the number that a text is, or nothing if it is none. Fortran's exponents (1.5D-3) and
// "nan" are numbers.
std::optional<double> ParseNumber(std::string_view text);

// Returns the numbers with which a line begins.
std::vector<double> LeadingNumbers(std::string_view line);

// Reads a file line by line. It keeps at most one long line in memory. Errors name the file and the
// line.
class NumberText {
 public:
  // A comment begins with one of the characters `comments` anywhere on a line, and ends with the
  // line.
  NumberText(std::shared_ptr<const base::ByteSource> bytes, std::string_view comments);

  // Goes to the next line that is neither blank nor only a comment. Returns false at the end.
  absl::StatusOr<bool> NextLine();

  // Goes to the next line like NextLine. It is an error if there is none. `what` is the content of
  // the line for the message, e.g. "the grid's size".
  absl::Status NeedLine(std::string_view what);

  // Returns what is left of the line.
  std::string_view Rest() const { return rest_; }

  // Returns whether another number follows on the line.
  bool AtNumber() const;

  // Returns the next number of the line.
  absl::StatusOr<double> Number(std::string_view what);

  // Returns the next number, which may be on a later line.
  absl::StatusOr<double> NumberOnAnyLine(std::string_view what);

  // Skips `count` numbers, which may be on several lines. A number that is repeated (3*0.5) takes
  // the same time as a single one.
  absl::Status SkipNumbers(int count, std::string_view what);

  // Returns the next number of the line, an integer from `low` to `high`.
  absl::StatusOr<int> Integer(std::string_view what, int low, int high);

  // Returns INVALID_ARGUMENT with "PATH: line N: MESSAGE".
  absl::Status Error(std::string_view message) const;

  std::size_t LineNumber() const { return line_number_; }

 private:
  absl::StatusOr<bool> NextRawLine(std::string_view& line);
  std::string_view NextWord() const;

  const std::shared_ptr<const base::ByteSource> bytes_;
  const std::string comments_;
  std::uint64_t offset_ = 0;  // offset in the file of the first byte that is not in `buffer_` yet
  std::string buffer_;
  std::size_t begin_ = 0;  // start of the first line in `buffer_` that was not returned yet
  std::size_t line_number_ = 0;
  std::string_view rest_;
  double repeated_ = 0.0;  // the value of Fortran's "3*0.5"
  int repeats_left_ = 0;
};

}  // namespace thunderhead::storm_files
