#include "storm_files/cell_methods.h"

#include <algorithm>
#include <array>
#include <map>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"

namespace thunderhead::storm_files {
namespace {

// Returns the words of the text in small letters, without comments in parentheses.
std::vector<std::string> WordsOf(std::string_view text) {
  std::string plain;
  int depth = 0;
  for (const char c : text) {
    if (c == '(') ++depth;
    if (depth == 0) plain += c;
    if (c == ')' && depth > 0) --depth;
  }
  return absl::StrSplit(absl::AsciiStrToLower(plain), absl::ByAnyChar(" \t\n"), absl::SkipEmpty());
}

template <std::size_t count>
bool IsIn(const std::array<std::string_view, count>& list, const std::string& word) {
  return std::ranges::find(list, word) != list.end();
}

// Returns whether the name is that of a dimension in space. A mean over such a dimension is the
// amount of a cell.
bool IsInSpace(const std::string& name) {
  constexpr std::array<std::string_view, 16> kNames = {
      "area", "volume", "lat", "lon", "latitude", "longitude", "rlat",  "rlon",
      "x",    "y",      "z",   "lev", "height",   "plev",      "level", "altitude"};
  return IsIn(kNames, name) || name.starts_with("grid_") || name.starts_with("projection_");
}

// Returns whether the results of the method are no amounts. "standard" begins a misspelt
// standard_deviation.
bool GivesNoAmount(const std::string& method) {
  constexpr std::array<std::string_view, 8> kMethods = {
      "variance", "standard_deviation", "standard",      "stddev", "range",
      "sum",      "root_mean_square",   "sum_of_squares"};
  return IsIn(kMethods, method);
}

}  // namespace

CellMethod MeaningOfCellMethods(std::string_view cell_methods) {
  CellMethod meaning = CellMethod::kValue;
  const std::vector<std::string> words = WordsOf(cell_methods);
  bool in_space = true;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    const bool follows_name = i > 0 && words[i - 1].ends_with(':');
    if (word.ends_with(':')) {
      in_space = (!follows_name || in_space) && IsInSpace(word.substr(0, word.size() - 1));
      continue;
    }
    if (follows_name && GivesNoAmount(word)) return CellMethod::kNoAmount;
    const bool is_value = word == "point" || (in_space && word == "mean");
    // The mean of a part of each cell, such as its clouds ("where"), is not that of the cell.
    if (follows_name ? !is_value : word == "where") meaning = CellMethod::kStatistic;
  }
  return meaning;
}

bool HoldsNoAmount(const netcdf::NetcdfFile& file, const std::string& variable) {
  return MeaningOfCellMethods(file.TextOrEmpty(variable, "cell_methods")) == CellMethod::kNoAmount;
}

absl::Status CheckCellMethods(const netcdf::NetcdfFile& file,
                              const std::vector<std::string>& variables,
                              std::vector<std::string>& assumptions) {
  std::map<std::string, std::vector<std::string>> statistics;  // variables by their cell_methods
  for (const std::string& variable : variables) {
    const std::string text = file.TextOrEmpty(variable, "cell_methods");
    const CellMethod meaning = MeaningOfCellMethods(text);
    if (meaning == CellMethod::kStatistic) statistics[text].push_back(variable);
    if (meaning != CellMethod::kNoAmount) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": ", variable, " has cell_methods '", text,
        "', so its values are no amounts of water; give values at single times, or means"));
  }
  for (const auto& [text, names] : statistics) {
    assumptions.push_back(absl::StrCat(
        absl::StrJoin(names, ", "),
        names.size() == 1 ? " is shown as the amount at each time, but it is a statistic"
                          : " are shown as the amounts at each time, but they are statistics",
        " (cell_methods '", text, "')."));
  }
  return absl::OkStatus();
}

absl::Status CheckScaleFactors(const netcdf::NetcdfFile& file,
                               const std::vector<std::string>& variables,
                               std::vector<std::string>& assumptions) {
  for (const std::string& variable : variables) {
    const std::optional<double> factor = file.NumberAttribute(variable, "scale_factor");
    // Factors that are no number are refused where the values are read.
    if (!factor.has_value() || !(*factor <= 0.0)) continue;
    const double offset = file.NumberAttribute(variable, "add_offset").value_or(0.0);
    if (*factor == 0.0) {
      assumptions.push_back(
          absl::StrCat(variable, " is ", offset, " everywhere, because its scale_factor is 0."));
    } else if (!(offset > 0.0)) {
      return absl::InvalidArgumentError(absl::StrCat(
          file.Path(), ": ", variable, " has the scale_factor ", *factor,
          " and no add_offset above 0, so its amounts would be negative; pack the values again, or "
          "unpack them, for example with ncpdq -U"));
    }
  }
  return absl::OkStatus();
}

}  // namespace thunderhead::storm_files
