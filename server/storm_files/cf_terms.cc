#include "storm_files/cf_terms.h"

#include <algorithm>
#include <array>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "base/status.h"
#include "storm_files/cf_axes.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

// Returns the variables of a formula_terms attribute by their terms.
CfTerms TermsOf(const std::string& attribute) {
  CfTerms terms;
  const std::vector<std::string> words = NamesIn(attribute);
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (!absl::EndsWith(words[i], ":")) continue;
    terms[absl::AsciiStrToLower(absl::StripSuffix(words[i], ":"))] = words[i + 1];
  }
  return terms;
}

std::optional<CfParametric> FindByAttribute(const netcdf::NetcdfFile& file, const CfDimension& z) {
  std::optional<CfParametric> found;
  CfTerms at_faces;
  for (const std::string& name : file.Variables()) {
    const std::string terms = file.TextOrEmpty(name, "formula_terms");
    const auto on = file.Dimensions(name);
    const auto shape = file.Shape(name);
    if (terms.empty() || !on.ok() || !shape.ok() || on->size() != 1) continue;
    if ((*on)[0] == z.name && !found.has_value()) {
      found = CfParametric{name, file.TextOrEmpty(name, "standard_name"), TermsOf(terms), {}};
      // The variable of the bounds has its own formula_terms, which give the terms at the faces.
      const std::string bounds = file.TextOrEmpty(name, "bounds");
      if (!bounds.empty() && file.HasVariable(bounds)) {
        found->terms_at_faces = TermsOf(file.TextOrEmpty(bounds, "formula_terms"));
      }
    } else if ((*shape)[0] == z.length + 1) {
      at_faces = TermsOf(terms);
    }
  }
  if (found.has_value() && !at_faces.empty()) found->terms_at_faces = at_faces;
  return found;
}

bool HasLength(const netcdf::NetcdfFile& file, const std::string& name, std::size_t length) {
  const auto shape = file.Shape(name);
  return shape.ok() && *shape == std::vector<std::size_t>{length};
}

// Returns the hybrid sigma pressure coordinate whose terms have the names of CAM and ECHAM.
std::optional<CfParametric> FindByNames(const netcdf::NetcdfFile& file, const CfDimension& z) {
  if (!HasLength(file, "hyam", z.length) || !HasLength(file, "hybm", z.length)) return std::nullopt;
  // ECHAM's hyam is a pressure, and CAM's is the share of a reference pressure.
  const bool is_pressure = ConversionOf(file.TextOrEmpty("hyam", "units"), "Pa").has_value();
  CfParametric found{z.coordinate.empty() ? z.name : z.coordinate,
                     "atmosphere_hybrid_sigma_pressure_coordinate",
                     {{is_pressure ? "ap" : "a", "hyam"},
                      {"b", "hybm"},
                      {"p0", file.HasVariable("p0") ? "p0" : "P0"},
                      {"ps", CfSurfacePressure(file)}},
                     {}};
  return found;
}

bool LiesAlong(const netcdf::NetcdfFile& file, const std::string& name, const CfDimension& z) {
  const auto on = file.Dimensions(name);
  return on.ok() && *on == std::vector<std::string>{z.name};
}

// Returns the hybrid height coordinate whose terms have the names that iris gives to those of the
// Unified Model.
std::optional<CfParametric> FindUnifiedModel(const netcdf::NetcdfFile& file, const CfDimension& z) {
  const std::string height_units = file.TextOrEmpty("level_height", "units");
  const std::string sigma_units = file.TextOrEmpty("sigma", "units");
  if (!LiesAlong(file, "level_height", z) || !LiesAlong(file, "sigma", z) ||
      !ConversionOf(height_units, "m").has_value() ||
      !(HasNoUnits(sigma_units) || ConversionOf(sigma_units, "1").has_value())) {
    return std::nullopt;
  }
  return CfParametric{"level_height",
                      "atmosphere_hybrid_height_coordinate",
                      {{"a", "level_height"}, {"b", "sigma"}, {"orog", "surface_altitude"}},
                      {}};
}

// Adds the faces that CAM and ECHAM write, if the coordinate has their names and no others.
void AddFacesByNames(const netcdf::NetcdfFile& file, const CfDimension& z,
                     CfParametric& coordinate) {
  if (!coordinate.terms_at_faces.empty() || !HasLength(file, "hyai", z.length + 1) ||
      !HasLength(file, "hybi", z.length + 1)) {
    return;
  }
  for (const auto& [term, variable] : coordinate.terms) {
    if (variable == "hyam") coordinate.terms_at_faces[term] = "hyai";
    if (variable == "hybm") coordinate.terms_at_faces[term] = "hybi";
  }
}

// Puts a term into the order of the layers, if it lies along another dimension of equal length, as
// CDO writes hyam. The number of each layer (1, 2, 3, ...) must be that of its value in the term.
absl::Status OrderByNumbers(const netcdf::NetcdfFile& file, const std::string& name,
                            const CfDimension& z, CfTermValues& term) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::string> on, file.Dimensions(name));
  if (on == std::vector<std::string>{z.name} || z.coordinate.empty()) return absl::OkStatus();
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> numbers, file.ReadDoubles(z.coordinate));
  const std::size_t layers = term.middles.size();
  bool rises = numbers.size() == layers;
  bool falls = rises;
  for (std::size_t i = 0; i < layers && (rises || falls); ++i) {
    rises = rises && numbers[i] == static_cast<double>(i + 1);
    falls = falls && numbers[i] == static_cast<double>(layers - i);
  }
  if (falls && !rises) {
    std::ranges::reverse(term.middles);
    std::ranges::reverse(term.faces);
  }
  if (rises || falls) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": ", name, ", a formula term, lies on another dimension than ",
                   z.coordinate, ", whose values are not 1 to ", layers,
                   ", so the term's order is not known; write both on ", z.name));
}

}  // namespace

std::string CfSurfacePressure(const netcdf::NetcdfFile& file) {
  for (const std::string& name : file.Variables()) {
    if (file.TextOrEmpty(name, "standard_name") == "surface_air_pressure") return name;
  }
  for (const char* name : {"PS", "ps", "aps", "sp"}) {
    if (file.HasVariable(name)) return name;
  }
  return "";
}

std::string CfTerm(const CfTerms& terms, const std::string& name) {
  const auto found = terms.find(name);
  return found == terms.end() ? "" : found->second;
}

std::optional<CfParametric> FindCfParametric(const netcdf::NetcdfFile& file,
                                             const CfDimensions& dimensions) {
  const CfDimension& z = dimensions.axes[2];
  std::optional<CfParametric> found = FindByAttribute(file, z);
  if (!found.has_value()) found = FindByNames(file, z);
  if (!found.has_value()) found = FindUnifiedModel(file, z);
  if (!found.has_value()) return std::nullopt;
  // CDO writes the standard name without "atmosphere", and others write the terms alone.
  const bool has_pressure_terms = found->terms.contains("b") && found->terms.contains("ps");
  if (has_pressure_terms &&
      (found->standard_name.empty() || found->standard_name == "hybrid_sigma_pressure")) {
    found->standard_name = "atmosphere_hybrid_sigma_pressure_coordinate";
  }
  AddFacesByNames(file, z, *found);
  return found;
}

absl::StatusOr<CfTermValues> ReadCfTerm(const netcdf::NetcdfFile& file,
                                        const CfParametric& coordinate, const std::string& term,
                                        const CfDimension& z, double scale) {
  const std::string name = CfTerm(coordinate.terms, term);
  CfTermValues values;
  THUNDERHEAD_ASSIGN_OR_RETURN(values.middles, file.ReadDoubles(name));
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto shape, file.Shape(name));
  const bool is_number = shape.empty() || (values.middles.size() == 1 && z.length > 1);
  if (is_number) {
    values.middles.resize(z.length, values.middles.front());
    values.faces.assign(z.length + 1, values.middles.front());
  }
  if (values.middles.size() != z.length) {
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": ", name,
                                                   ", a formula term, has ", values.middles.size(),
                                                   " values for ", z.length, " layers"));
  }
  const std::string at_faces = CfTerm(coordinate.terms_at_faces, term);
  if (at_faces != name && file.HasVariable(at_faces)) {
    if (HasLength(file, at_faces, z.length + 1)) {
      THUNDERHEAD_ASSIGN_OR_RETURN(values.faces, file.ReadDoubles(at_faces));
    } else {
      THUNDERHEAD_ASSIGN_OR_RETURN(values.faces, ReadBoundsIn(file, at_faces, name, z.length, 0.0));
    }
  }
  if (values.faces.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(values.faces, ReadBounds(file, name, z.length, 0.0));
  }
  if (!is_number) THUNDERHEAD_RETURN_IF_ERROR(OrderByNumbers(file, name, z, values));
  for (double& value : values.middles) value *= scale;
  for (double& value : values.faces) value *= scale;
  return values;
}

}  // namespace thunderhead::storm_files
