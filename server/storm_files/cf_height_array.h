// Finds the array of heights in a CF file, and matches its levels to the layers of the fields by
// their level numbers. A file may have fields of only some layers, but the heights of all layers.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_arrange.h"
#include "storm_files/cf_heights.h"

namespace thunderhead::storm_files {

// Returns whether the list has the text.
bool OneOf(std::string_view text, std::initializer_list<std::string_view> list);

// Returns the metres in a unit of height or of geopotential. It is absent for other units.
std::optional<double> HeightScale(const std::string& units);

// Returns whether a variable of heights is above the ground, by its standard name or long name.
bool IsAboveGround(const netcdf::NetcdfFile& file, const std::string& variable,
                   const CfDescription& described);

// Returns whether a vertical coordinate with these attributes counts levels: it has no unit of
// length or pressure.
bool CountsLevels(const CfDescription& coordinate);

struct CfHeightArray {
  std::optional<CfHeights> heights;      // absent if no array gives the heights of the layers
  absl::Status unread;                   // why the first unsuitable array cannot be used, if any
  std::vector<std::string> assumptions;  // sentences about `heights`
};

// Returns the heights of the layers of the fields in `fields`. They are those of an array in
// `file`, which has the same columns and may be another file. `dimensions` are those of the fields.
//
// An array of the faces of layers (half levels) is preferred to one of their middles. Level k of
// COSMO and ICON lies between the half levels k and k + 1. An array whose levels cannot be matched
// to the layers is not used, and CfHeightArray::unread says why. Errors are those of reading the
// files.
absl::StatusOr<CfHeightArray> FindHeightArray(const netcdf::NetcdfFile& file,
                                              const CfDimensions& dimensions,
                                              const netcdf::NetcdfFile& fields);

// Returns the variable with the heights of COSMO's or ICON's half levels (HHL, z_ifc), or an empty
// text.
std::string NameOfHalfLevels(const netcdf::NetcdfFile& file);

}  // namespace thunderhead::storm_files
