// The heights of a CF file's layers: from an axis in metres, from an array of heights, or computed
// from the formula_terms of a parametric coordinate (CF, appendix D). Level numbers, eta and
// pressure without the means to compute heights are refused.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_arrange.h"
#include "storm_files/cf_axes.h"

namespace thunderhead::storm_files {

// A variable with a value for each column: terrain, or surface pressure.
struct CfColumnValue {
  CfVariable variable;
  double scale = 1.0;  // factor from the variable's unit to m or Pa
};

enum class CfHeightKind {
  kAxis,         // faces above sea level, the same in all columns
  kAboveGround,  // faces above the surface
  kMiddles,      // an array of heights of the layers' middles
  kFaces,        // an array of heights of the faces
  kLinear,       // a + the sum of b * surface, of one or two surfaces
  kPressure,     // pressure a + b * surface pressure, and heights by the hydrostatic equation
  kIsobaric,     // levels of constant pressure, and heights by the hydrostatic equation
};

// Returns whether the heights follow from the temperature of the air.
constexpr bool FollowFromAir(CfHeightKind kind) {
  return kind == CfHeightKind::kPressure || kind == CfHeightKind::kIsobaric;
}

// A term b * surface of the height of a face.
struct CfSurfaceTerm {
  std::vector<double> b;  // at the faces, upwards, one more than layers
  CfColumnValue surface;
};

// The heights of layers, in the order of the file unless a member says otherwise.
struct CfHeights {
  CfHeightKind kind = CfHeightKind::kAxis;
  std::string name;                 // name of the variable with the heights, for messages
  bool reversed = false;            // the file's layers run downwards
  std::vector<double> faces_m;      // only for kAxis and kAboveGround, ascending
  std::optional<CfVariable> array;  // the array of heights; only for kMiddles and kFaces
  double scale = 1.0;               // factor from the array's unit to m
  bool above_ground = false;        // true if the array's heights are above the ground
  std::optional<double> ground_m;   // the height of flat ground, if the file gives it as a number
  // The ground, if it is the lowest face of the array and the layers end above it.
  std::optional<CfColumnValue> ground;
  // The term a of kLinear and kPressure at the faces, upwards, one more than layers.
  std::vector<double> a;                // in m or Pa
  std::vector<CfSurfaceTerm> surfaces;  // only for kLinear: heights of the ground, or parts of them
  std::vector<double> b;                // the term b of kPressure, at the same faces as `a`
  std::optional<CfColumnValue> surface_pressure;  // only for kPressure and kIsobaric
  // The terms of kPressure at the layers' middles, upwards. For kIsobaric, a_middle has the
  // pressures of the levels in Pa, and b_middle is empty.
  std::vector<double> a_middle;
  std::vector<double> b_middle;
};

// Returns the heights of the layers of `dimensions`. `terrain` is the file's height of the ground,
// if it has one. An array of heights may be in `heights_file`, which is null if there is none. Adds
// sentences to `assumptions`. Errors name the file, the coordinate and what is needed.
absl::StatusOr<CfHeights> ReadCfHeights(const netcdf::NetcdfFile& file,
                                        const netcdf::NetcdfFile* heights_file,
                                        const CfDimensions& dimensions,
                                        const std::optional<CfColumnValue>& terrain,
                                        std::vector<std::string>& assumptions);

// Returns the terrain height. This is the variable with the standard name surface_altitude, the
// geopotential at the surface, or a variable with a name that models use for it. `dimensions` may
// lack z.
std::optional<CfColumnValue> FindTerrain(const netcdf::NetcdfFile& file,
                                         const CfDimensions& dimensions,
                                         std::vector<std::string>& assumptions);

}  // namespace thunderhead::storm_files
