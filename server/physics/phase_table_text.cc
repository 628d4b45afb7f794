// The text form of a phase table. In the line `forward_share`, an angle in degrees is followed by
// the share of light within it. The line `angles` gives the number of lines below it. Each of these
// lines holds an angle in degrees and the values at that angle for red, green and blue:
//
//   # comments
//   name cloud_re10
//   wavelengths_um 0.65 0.55 0.45
//   asymmetry 0.8626 0.8618 0.8629
//   forward_share 5 0.58 0.57 0.56
//
//   angles 3
//   0 9000 12000 18000
//   ...
#include <cmath>
#include <iterator>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "base/status.h"
#include "physics/phase_table.h"

namespace thunderhead::physics {
namespace {

// Tolerance for the mean over the sphere and for the figures in the header. Values are written with
// six digits, so the errors of a valid file are much smaller.
constexpr double kFileTolerance = 1e-3;

absl::string_view AbslView(std::string_view text) { return {text.data(), text.size()}; }

absl::Status LineError(int line, std::string_view what) {
  return absl::InvalidArgumentError(
      absl::StrFormat("line %d: %s; regenerate the file with ./dev tables", line, AbslView(what)));
}

// Iterates over the lines of a text that are neither empty nor comments, split into words.
class Lines {
 public:
  explicit Lines(std::string_view text) : lines_(absl::StrSplit(AbslView(text), '\n')) {}

  // Returns the words of the next line, or none at the end of the text.
  std::vector<absl::string_view> Next() {
    while (next_ < lines_.size()) {
      const absl::string_view line = lines_[next_++];
      std::vector<absl::string_view> words =
          absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
      if (!words.empty() && words.front().front() != '#') return words;
    }
    return {};
  }

  int number() const { return static_cast<int>(next_); }

  // Returns the numbers of the next line, which must consist of `key` and `count` numbers. If the
  // key is empty, the line has only numbers.
  absl::StatusOr<std::vector<double>> Numbers(std::string_view key, std::size_t count) {
    const std::vector<absl::string_view> words = Next();
    const std::size_t first = key.empty() ? 0 : 1;
    if (words.size() != first + count || (first == 1 && words.front() != AbslView(key))) {
      return LineError(number(),
                       absl::StrFormat("%s%s%d numbers expected, got %d words", AbslView(key),
                                       key.empty() ? "" : " and ", count, words.size()));
    }
    std::vector<double> numbers(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (!absl::SimpleAtod(words[first + i], &numbers[i]) || !std::isfinite(numbers[i])) {
        return LineError(number(), absl::StrCat("'", words[first + i], "' is not a finite number"));
      }
    }
    return numbers;
  }

 private:
  std::vector<absl::string_view> lines_;
  std::size_t next_ = 0;
};

struct Header {
  PhaseRgb asymmetry{};
  double forward_angle_deg = 0.0;
  PhaseRgb forward_share{};
  std::size_t angles = 0;
};

absl::StatusOr<Header> ReadHeader(Lines& lines, PhaseTableContent& content) {
  const std::vector<absl::string_view> words = lines.Next();
  if (words.size() != 2 || words.front() != "name") {
    return LineError(lines.number(), "name and one word expected");
  }
  content.name = std::string(words[1]);
  Header header;
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> wavelengths,
                               lines.Numbers("wavelengths_um", kPhaseChannels));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> asymmetry,
                               lines.Numbers("asymmetry", kPhaseChannels));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> forward,
                               lines.Numbers("forward_share", 1 + kPhaseChannels));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> angles, lines.Numbers("angles", 1));
  if (angles[0] < 2.0 || angles[0] > 1e6) {
    return LineError(lines.number(), "the number of angles must be 2 to 1000000");
  }
  header.angles = static_cast<std::size_t>(angles[0]);
  header.forward_angle_deg = forward[0];
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    content.wavelengths_um[c] = wavelengths[c];
    header.asymmetry[c] = asymmetry[c];
    header.forward_share[c] = forward[1 + c];
  }
  return header;
}

// Checks that the figures in the header agree with the tabulated curve.
absl::Status CheckFigures(const Header& header, const PhaseTable& table) {
  if (header.forward_angle_deg != PhaseTable::kForwardAngleDeg) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "the line forward_share gives the share within %g degrees; it must be within "
        "%g degrees; regenerate the file with ./dev tables",
        header.forward_angle_deg, PhaseTable::kForwardAngleDeg));
  }
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    const double share = table.ForwardShare(c);
    if (std::abs(header.asymmetry[c] - table.Asymmetry(c)) > kFileTolerance ||
        std::abs(header.forward_share[c] - share) > kFileTolerance) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "channel %d: asymmetry %g and forward share %g are stated, but the values have %g and "
          "%g; regenerate the file with ./dev tables",
          c, header.asymmetry[c], header.forward_share[c], table.Asymmetry(c), share));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<PhaseTable> PhaseTable::Load(std::string_view text) {
  Lines lines(text);
  PhaseTableContent content;
  THUNDERHEAD_ASSIGN_OR_RETURN(const Header header, ReadHeader(lines, content));
  for (std::size_t i = 0; i < header.angles; ++i) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> row,
                                 lines.Numbers("", 1 + kPhaseChannels));
    content.angles_deg.push_back(row[0]);
    content.values.push_back({row[1], row[2], row[3]});
  }
  if (!lines.Next().empty()) {
    return LineError(lines.number(),
                     absl::StrFormat("more than the %d angles that are stated", header.angles));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(PhaseTable table, Create(std::move(content), kFileTolerance));
  THUNDERHEAD_RETURN_IF_ERROR(CheckFigures(header, table));
  return table;
}

std::string PhaseTable::ToText(std::string_view provenance) const {
  std::string text = "# Thunderhead phase table; written by ./dev tables, not by hand.\n";
  for (const absl::string_view line : absl::StrSplit(AbslView(provenance), '\n')) {
    absl::StrAppend(&text, line.empty() ? "#" : "# ", line, "\n");
  }
  const PhaseRgb& um = content_.wavelengths_um;
  absl::StrAppendFormat(&text, "name %s\nwavelengths_um %g %g %g\n", content_.name, um[0], um[1],
                        um[2]);
  absl::StrAppendFormat(&text, "asymmetry %.5f %.5f %.5f\n", asymmetry_[0], asymmetry_[1],
                        asymmetry_[2]);
  absl::StrAppendFormat(&text, "forward_share %g %.5f %.5f %.5f\n", kForwardAngleDeg,
                        ForwardShare(0), ForwardShare(1), ForwardShare(2));
  absl::StrAppendFormat(&text, "angles %d\n", content_.angles_deg.size());
  for (std::size_t i = 0; i < content_.angles_deg.size(); ++i) {
    const PhaseRgb& value = content_.values[i];
    absl::StrAppendFormat(&text, "%.6g %.6g %.6g %.6g\n", content_.angles_deg[i], value[0],
                          value[1], value[2]);
  }
  return text;
}

}  // namespace thunderhead::physics
