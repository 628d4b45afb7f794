#include "storm_files/shdom_format.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "storm_files/cloud_text.h"
#include "storm_files/text_start.h"

namespace thunderhead::storm_files {
namespace {

constexpr int kMostPhaseFunctions = 1'000'000;

// Reads the temperatures in K, one for each height.
absl::Status ReadTemperatures(NumberText& text, CloudHeader& header) {
  for (std::size_t i = 0; i < header.heights_m.size(); ++i) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const double each_K, text.NumberOnAnyLine("a temperature"));
    header.temperature_K.push_back(each_K);
  }
  return absl::OkStatus();
}

// Reads the header of a particle file, whose first line begins with its type.
absl::StatusOr<CloudHeader> ReadParticleHeader(NumberText& text) {
  CloudHeader header;
  const bool has_extinction =
      absl::StrContains(absl::AsciiStrToLower(std::string(text.Rest())), "extinction file");
  THUNDERHEAD_ASSIGN_OR_RETURN(const int type, text.Integer("the type of the file", 1, 3));
  if (has_extinction) {
    return text.Error(
        "begins an extinction file, whose values are in another file; give a file with "
        "liquid water contents");
  }
  header.about = absl::StrCat("SHDOM particle file of type ", type);
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the size of the grid"));
  THUNDERHEAD_RETURN_IF_ERROR(ReadCloudSize(text, header));
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the distance between columns"));
  THUNDERHEAD_RETURN_IF_ERROR(ReadCloudSpacing(text, header));
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the heights"));
  THUNDERHEAD_RETURN_IF_ERROR(ReadCloudHeights(text, true, header));
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the temperatures"));
  THUNDERHEAD_RETURN_IF_ERROR(ReadTemperatures(text, header));
  header.variable = type == 3 ? "mass" : "lwc";
  header.columns.has_components = type == 3;
  if (type == 1) {
    header.assumptions.emplace_back(
        "The file has no radii: SHDOM computes them from a number of droplets that it is told.");
  } else if (type == 2) {
    header.columns.values = 2;
    header.columns.radius_at = 1;
  }
  return header;
}

// Skips a phase function or, of a polarized file, one of its six series.
absl::Status SkipPhaseFunction(NumberText& text, bool is_polarized) {
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("a phase function"));
  if (is_polarized) {
    THUNDERHEAD_RETURN_IF_ERROR(text.Integer("the number of a series", 1, 6).status());
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(int terms,
                               text.Integer("the degree of a phase function", 0, kMostSeriesTerms));
  if (is_polarized) ++terms;  // a polarized series also lists the term of degree 0
  return text.SkipNumbers(terms, "a term of a phase function");
}

absl::Status ReadRestOfExtinctionHeader(NumberText& text, CloudHeader& header) {
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the temperatures"));
  THUNDERHEAD_RETURN_IF_ERROR(ReadTemperatures(text, header));
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the albedo and the phase function"));
  THUNDERHEAD_RETURN_IF_ERROR(text.Number("the albedo").status());
  THUNDERHEAD_ASSIGN_OR_RETURN(const int terms,
                               text.Integer("the degree of a phase function", 0, kMostSeriesTerms));
  THUNDERHEAD_RETURN_IF_ERROR(text.SkipNumbers(terms, "a term of a phase function"));
  header.columns.has_y = header.cells.y > 1;
  return absl::OkStatus();
}

absl::Status ReadRestOfTabulatedHeader(NumberText& text, bool is_polarized, CloudHeader& header) {
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the number of phase functions"));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const int functions, text.Integer("the number of phase functions", 1, kMostPhaseFunctions));
  constexpr int kSeries = 6;
  for (int i = 0; i < functions * (is_polarized ? kSeries : 1); ++i) {
    THUNDERHEAD_RETURN_IF_ERROR(SkipPhaseFunction(text, is_polarized));
  }
  header.columns.values = 4;  // temperature, extinction, albedo, phase function
  header.columns.amount_at = 1;
  return absl::OkStatus();
}

// Reads the header of a property file. `kind` is E, T, P, or a blank for the standard format.
absl::StatusOr<CloudHeader> ReadPropertyHeader(NumberText& text, char kind) {
  CloudHeader header;
  header.about = "SHDOM property file";
  header.quantity = volume::Quantity::kExtinction;
  header.variable = "extinction";
  if (kind != ' ') THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the size of the grid"));
  THUNDERHEAD_RETURN_IF_ERROR(ReadCloudSize(text, header));
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the distances and heights"));
  THUNDERHEAD_RETURN_IF_ERROR(ReadCloudSpacing(text, header));
  THUNDERHEAD_RETURN_IF_ERROR(ReadCloudHeights(text, false, header));
  header.assumptions.emplace_back("The layout names no unit of length. It is taken as km.");
  header.assumptions.emplace_back("Albedos and phase functions of the file are not used.");
  if (kind == 'E') {
    THUNDERHEAD_RETURN_IF_ERROR(ReadRestOfExtinctionHeader(text, header));
  } else if (kind != ' ') {
    THUNDERHEAD_RETURN_IF_ERROR(ReadRestOfTabulatedHeader(text, kind == 'P', header));
  } else {
    header.columns.values = 3;  // temperature, extinction, albedo
    header.columns.amount_at = 1;
    header.columns.has_series = true;
  }
  return header;
}

// Returns the kind of a property file that begins with this line: E, T, P, or a blank.
char PropertyKindOf(std::string_view first_line) {
  const char first = first_line.empty() ? ' ' : first_line.front();
  return first == 'E' || first == 'T' || first == 'P' ? first : ' ';
}

absl::StatusOr<CloudHeader> ReadShdomHeader(NumberText& text) {
  THUNDERHEAD_RETURN_IF_ERROR(text.NeedLine("the header"));
  const char kind = PropertyKindOf(text.Rest());
  constexpr std::size_t kSize = 3;
  const bool is_property = kind != ' ' || LeadingNumbers(text.Rest()).size() >= kSize;
  return is_property ? ReadPropertyHeader(text, kind) : ReadParticleHeader(text);
}

constexpr CloudDialect kShdomDialect = {"SHDOM", "", ReadShdomHeader};

bool LooksLikeParticleFile(const std::vector<StartLine>& lines) {
  constexpr std::size_t kHeader = 4;
  if (lines.size() < kHeader || lines[0].numbers.size() != 1) return false;
  const double type = lines[0].numbers[0];
  return (type == 1.0 || type == 2.0 || type == 3.0) && lines[1].BeginsWithSize() &&
         !lines[2].numbers.empty() && !lines[3].numbers.empty();
}

bool LooksLikePropertyFile(const std::vector<StartLine>& lines) {
  if (lines.size() < 2) return false;
  if (PropertyKindOf(lines[0].text) != ' ') {
    constexpr std::size_t kFewest = 3;  // two distances and a height
    return lines.size() > 2 && lines[1].BeginsWithSize() && lines[2].only_numbers &&
           lines[2].numbers.size() >= kFewest;
  }
  constexpr std::size_t kSize = 3;
  constexpr std::size_t kValues = 7;  // values on a line of the standard format, without the series
  if (!lines[0].BeginsWithSize() || !lines[0].HasNumbers(kSize)) return false;
  const auto levels = static_cast<std::size_t>(lines[0].numbers[2]);
  return lines[1].HasNumbers(2 + levels) &&
         (lines.size() == 2 || lines[2].is_cut || lines[2].numbers.size() >= kValues);
}

// Reads two kinds of layouts. All are in km, g m-3 and um, with indices from 1:
// - Particle files of types 2 and 3 are documented in SHDOM's propgen.f90, whose heights are those
//   of grid points. The I3RC model's PhysicalPropertiesToDomain documents types 1 to 3, and has one
//   height more, those of the faces of layers. AT3D (util.py, to_2parameter_lwc_file) writes
//   type 2.
// - Property files are documented in SHDOM's shdom.txt, "Property file format". They have only
//   extinction (E), tabulated phase functions (T), the same for polarized light (P), or the
//   standard format. Extinction is in the inverse unit of the distances, which propgen.f90 writes
//   in km.
// Numbers are read as by Fortran: they may continue on further lines of the header, and text after
// the numbers of a line is ignored.
class ShdomFormat final : public StormFormat {
 public:
  std::string_view Name() const override { return "an SHDOM file"; }
  std::string_view Example() const override { return "SHDOM text"; }
  std::string_view Requirement() const override {
    return "an SHDOM particle or property file (it does not begin with such a header)";
  }

  bool MayBegin(std::string_view start) const override {
    const std::vector<StartLine> lines = FirstTextLines(start, kShdomDialect.comments);
    return LooksLikeParticleFile(lines) || LooksLikePropertyFile(lines);
  }

  FormatFit Sniff(const UnknownFile& file) const override {
    return MayBegin(file.Start()) ? FormatFit::kModelLayout : FormatFit::kNone;
  }

  absl::StatusOr<StormFile> Describe(const UnknownFile& file) const override {
    THUNDERHEAD_RETURN_IF_ERROR(file.Bytes().status());
    return DescribeCloudText(*file.Bytes(), kShdomDialect);
  }
};

}  // namespace

std::shared_ptr<const StormFormat> MakeShdomFormat() { return std::make_shared<ShdomFormat>(); }

}  // namespace thunderhead::storm_files
