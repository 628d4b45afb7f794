// Reads the parts of section 3 that several grids share: the shape of the Earth, the number of
// points, the scanning mode, angles and steps. Errors are INVALID_ARGUMENT for what is not
// supported, with its name, and DATA_LOSS for contradictory numbers. They do not name the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "glm/vec2.hpp"
#include "grib/grid.h"
#include "grib/octets.h"

namespace thunderhead::grib {

inline constexpr double kMicrodegrees = 1e-6;

// Returns INVALID_ARGUMENT with the text "its grid WHAT", and what to do.
absl::Status UnreadGrid(std::string_view what);

// Returns DATA_LOSS with the text "its grid WHAT", and what to do.
absl::Status BadGrid(std::string_view what);

// The shape of the Earth (code table 3.2).
struct Earth {
  double equator_m = 0.0;  // radius at the equator
  double pole_m = 0.0;     // radius at the poles

  bool IsSphere() const { return equator_m == pole_m; }
  // Returns the parameters for PROJ.
  std::string Text() const;
};

absl::StatusOr<Earth> EarthOf(const Octets& section);

// Reads the scanning mode (flag table 3.4) into the grid.
absl::Status ReadScanning(std::uint64_t mode, Grid& grid);

// Reads the numbers of columns and rows, whose product must be the number of points.
absl::Status ReadSize(const Octets& section, Grid& grid);

// Sets south_west from the first point in the file.
void SetCorner(const glm::dvec2& first, Grid& grid);

// Returns the unit of angles in degrees, of templates 3.0 and 3.40.
absl::StatusOr<double> AngleUnit_deg(const Octets& section);

// Returns the angle from the first to the last meridian, above 0 and up to 360 degrees, 0 for one
// column. `unit` is that of AngleUnit_deg.
double LongitudeRange_deg(const Octets& section, double unit_deg, const Grid& grid);

// Returns the step in degrees between neighbouring latitudes or longitudes of a grid, which are
// called `name` in errors. If there are several (`count`), it follows from `range_deg`, the
// distance of the first and the last. A step in `octet` must then agree. If there is only one,
// returns the step in `octet`, or 0 if the file does not give it.
absl::StatusOr<double> StepOf(const Octets& section, std::size_t octet, double unit_deg,
                              double range_deg, int count, const char* name);

// Copies the step of the other axis to an axis with a single row or column whose step the file does
// not give. Returns an error if neither axis has a step.
absl::Status CompleteSteps(Grid& grid);

// Returns whether winds are along the grid's axes, by the flags in `octet` (flag table 3.3).
bool IsWindAlongGrid(const Octets& section, std::size_t octet);

}  // namespace thunderhead::grib
