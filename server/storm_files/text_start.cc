#include "storm_files/text_start.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "storm_files/number_text.h"

namespace thunderhead::storm_files {
namespace {

constexpr std::string_view kBlanks = " \t\r,";

bool IsText(char c) {
  return static_cast<unsigned char>(c) >= ' ' || c == '\t' || c == '\n' || c == '\r';
}

std::size_t CountWords(std::string_view text) {
  std::size_t count = 0;
  for (std::size_t at = text.find_first_not_of(kBlanks); at != std::string_view::npos;
       at = text.find_first_not_of(kBlanks, at)) {
    ++count;
    at = std::min(text.find_first_of(kBlanks, at), text.size());
  }
  return count;
}

std::string_view Trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
}

}  // namespace

bool StartLine::BeginsWithSize() const {
  constexpr std::ptrdiff_t kAxes = 3;
  return std::ssize(numbers) >= kAxes &&
         std::all_of(numbers.begin(), numbers.begin() + kAxes, [](double number) {
           return number >= 1.0 && number <= kMostGridPoints && number == std::floor(number);
         });
}

bool StartLine::HasNumbers(std::size_t count) const {
  return is_cut ? numbers.size() <= count : only_numbers && numbers.size() == count;
}

std::vector<StartLine> FirstTextLines(std::string_view start, std::string_view comments) {
  if (!std::ranges::all_of(start, IsText)) return {};
  std::vector<StartLine> lines;
  while (!start.empty()) {
    StartLine line;
    const std::size_t end = start.find('\n');
    const std::string_view whole = start.substr(0, end);
    start.remove_prefix(std::min(end, start.size() - 1) + 1);
    const std::size_t comment =
        comments.empty() ? std::string_view::npos : whole.find_first_of(comments);
    // The file's last line may have no line feed. It then counts as cut.
    line.is_cut = end == std::string_view::npos && comment == std::string_view::npos;
    line.text = Trimmed(whole.substr(0, comment));
    if (line.text.empty()) continue;
    line.numbers = LeadingNumbers(line.text);
    line.only_numbers = line.numbers.size() == CountWords(line.text);
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace thunderhead::storm_files
