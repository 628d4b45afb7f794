// The formula terms of a parametric vertical coordinate in a CF file (CF, appendix D), and their
// values in layers and on the faces between them.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_arrange.h"

namespace thunderhead::storm_files {

// The variables of a formula by the names of its terms, in small letters.
using CfTerms = std::map<std::string, std::string>;

// A parametric coordinate and, if the file has them, the terms at the faces between its layers.
struct CfParametric {
  std::string name;
  std::string standard_name;  // empty if the file has none
  CfTerms terms;
  CfTerms terms_at_faces;
};

// The values of a term along z, in the order of the file.
struct CfTermValues {
  std::vector<double> middles;
  std::vector<double> faces;  // one more than middles; empty if the file has none
};

// Returns the parametric coordinate of the layers by its formula_terms, or by the names that CAM
// and ECHAM (hyam, hybm) or iris (level_height, sigma) give to the terms. Returns nothing if the
// file has none.
std::optional<CfParametric> FindCfParametric(const netcdf::NetcdfFile& file,
                                             const CfDimensions& dimensions);

// Returns the variable with the pressure at the surface, or an empty text.
std::string CfSurfacePressure(const netcdf::NetcdfFile& file);

// Returns the variable of a term, or an empty text.
std::string CfTerm(const CfTerms& terms, const std::string& name);

// Reads a term that is a number or lies along z, times `scale`. Its faces are the term's bounds, or
// the variable of the same term at the faces: either one value for each face, or two for each
// layer. Errors name the file, the variable and what is wrong.
absl::StatusOr<CfTermValues> ReadCfTerm(const netcdf::NetcdfFile& file,
                                        const CfParametric& coordinate, const std::string& term,
                                        const CfDimension& z, double scale);

}  // namespace thunderhead::storm_files
