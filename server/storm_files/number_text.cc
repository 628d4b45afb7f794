#include "storm_files/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::storm_files {
namespace {

constexpr std::string_view kSeparators = " \t\r,";
constexpr std::size_t kBlock_bytes = 1 << 18;
constexpr std::size_t kLongestLine_bytes = 1 << 20;

std::string_view WithoutLeadingSeparators(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kSeparators);
  return begin == std::string_view::npos ? std::string_view() : text.substr(begin);
}

std::string_view FirstWordOf(std::string_view text) {
  return text.substr(0, text.find_first_of(kSeparators));
}

// Returns a part of a line for a message.
std::string QuotedPart(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  return absl::StrCat("'", absl::CEscape(std::string(text.substr(0, kLongest))), "'");
}

// Splits Fortran's "3*0.5" into 3 and "0.5". Returns 1 for a word without a count.
int TakeRepeats(std::string_view& word) {
  const std::size_t star = word.find('*');
  if (star == std::string_view::npos) return 1;
  int count = 0;
  if (!absl::SimpleAtoi(std::string(word.substr(0, star)), &count) || count < 1) return 1;
  word.remove_prefix(star + 1);
  return count;
}

}  // namespace

std::optional<double> ParseNumber(std::string_view text) {
  std::array<char, 64> copy{};
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  if (text.empty() || text.size() > copy.size()) return std::nullopt;
  std::ranges::transform(text, copy.begin(), [](char c) { return c == 'D' || c == 'd' ? 'E' : c; });
  double number = 0.0;
  const char* const end = copy.data() + text.size();
  const auto result = std::from_chars(copy.data(), end, number);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return number;
}

std::vector<double> LeadingNumbers(std::string_view line) {
  std::vector<double> numbers;
  for (line = WithoutLeadingSeparators(line); !line.empty();) {
    const std::string_view word = FirstWordOf(line);
    const std::optional<double> number = ParseNumber(word);
    if (!number.has_value()) break;
    numbers.push_back(*number);
    line = WithoutLeadingSeparators(line.substr(word.size()));
  }
  return numbers;
}

NumberText::NumberText(std::shared_ptr<const base::ByteSource> bytes, std::string_view comments)
    : bytes_(std::move(bytes)), comments_(comments) {}

absl::Status NumberText::Error(std::string_view message) const {
  return absl::InvalidArgumentError(
      absl::StrCat(bytes_->Path(), ": line ", line_number_, ": ", std::string(message)));
}

absl::StatusOr<bool> NumberText::NextRawLine(std::string_view& line) {
  std::size_t searched = begin_;
  while (true) {
    const std::size_t end = buffer_.find('\n', searched);
    const bool is_last = offset_ >= bytes_->Size_bytes();
    if (end != std::string::npos || (is_last && begin_ < buffer_.size())) {
      const std::size_t stop = std::min(end, buffer_.size());
      line = std::string_view(buffer_).substr(begin_, stop - begin_);
      begin_ = std::min(stop + 1, buffer_.size());
      ++line_number_;
      return true;
    }
    if (is_last) return false;
    buffer_.erase(0, begin_);
    begin_ = 0;
    searched = buffer_.size();
    if (buffer_.size() > kLongestLine_bytes) {
      ++line_number_;
      return Error("is longer than 1 MiB; write it in several lines");
    }
    const std::uint64_t count =
        std::min<std::uint64_t>(kBlock_bytes, bytes_->Size_bytes() - offset_);
    buffer_.resize(searched + count);
    THUNDERHEAD_RETURN_IF_ERROR(
        bytes_->Read(offset_, std::as_writable_bytes(std::span(buffer_).subspan(searched))));
    offset_ += count;
  }
}

absl::StatusOr<bool> NumberText::NextLine() {
  repeats_left_ = 0;
  while (true) {
    rest_ = {};
    std::string_view line;
    THUNDERHEAD_ASSIGN_OR_RETURN(const bool found, NextRawLine(line));
    if (!found) return false;
    if (!comments_.empty()) line = line.substr(0, line.find_first_of(comments_));
    rest_ = WithoutLeadingSeparators(line);
    if (!rest_.empty()) return true;
  }
}

absl::Status NumberText::NeedLine(std::string_view what) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const bool found, NextLine());
  if (found) return absl::OkStatus();
  return Error(
      absl::StrCat("is the last, but ", std::string(what), " should follow; write the file again"));
}

bool NumberText::AtNumber() const {
  if (repeats_left_ > 0) return true;
  std::string_view word = FirstWordOf(rest_);
  TakeRepeats(word);
  return ParseNumber(word).has_value();
}

absl::StatusOr<double> NumberText::Number(std::string_view what) {
  if (repeats_left_ > 0) {
    --repeats_left_;
    return repeated_;
  }
  if (rest_.empty())
    return Error(absl::StrCat("ends before ", std::string(what), "; write it again"));
  std::string_view word = FirstWordOf(rest_);
  const std::string_view whole = word;
  repeats_left_ = TakeRepeats(word) - 1;
  const std::optional<double> number = ParseNumber(word);
  if (!number.has_value()) {
    return Error(absl::StrCat("has ", QuotedPart(whole), " for ", std::string(what),
                              ", which is not a number; correct it"));
  }
  rest_ = WithoutLeadingSeparators(rest_.substr(whole.size()));
  repeated_ = *number;
  return repeated_;
}

absl::StatusOr<double> NumberText::NumberOnAnyLine(std::string_view what) {
  if (rest_.empty() && repeats_left_ == 0) THUNDERHEAD_RETURN_IF_ERROR(NeedLine(what));
  return Number(what);
}

absl::Status NumberText::SkipNumbers(int count, std::string_view what) {
  while (count > 0) {
    THUNDERHEAD_RETURN_IF_ERROR(NumberOnAnyLine(what).status());
    --count;
    const int repeats = std::min(count, repeats_left_);
    repeats_left_ -= repeats;
    count -= repeats;
  }
  return absl::OkStatus();
}

absl::StatusOr<int> NumberText::Integer(std::string_view what, int low, int high) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const double number, Number(what));
  if (number >= low && number <= high && number == std::floor(number)) {
    return static_cast<int>(number);
  }
  return Error(absl::StrCat("has ", number, " for ", std::string(what),
                            ", which is an integer from ", low, " to ", high, "; correct it"));
}

}  // namespace thunderhead::storm_files
