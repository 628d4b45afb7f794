// The cloud generator of P. Man, "Generating and Real-Time Rendering of Clouds" (docs/clouds.md).
// It computes liquid water on a grid from noise inside a union of ellipsoids (eq. 1, 8-10). The
// same parameters give the same bits on every machine.
#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "absl/status/statusor.h"
#include "clouds/cloud_shape.h"

namespace thunderhead::clouds {

// A function that is called between slices of the grid with the part of the work done, 0 to 1.
using GenerateObserver = std::function<void(double share)>;

// Returns INVALID_ARGUMENT if a parameter is out of range. The message names the parameter.
absl::Status CheckShape(const CloudShape& shape);

// Returns the liquid water (kg/m3) of every cell, x fastest. At a cell's centre, N is the noise,
// and Q the largest of the ellipsoids' quadrics. By eq. 10, the density D is d N Q where N Q >= t,
// and 0 elsewhere. (In its text, the paper uses Q for the product N Q.) Returns an error if a
// parameter is out of range, or if all cells would be empty. Returns CANCELLED if `stop` requests
// it.
absl::StatusOr<std::vector<float>> Generate(const CloudShape& shape,
                                            const GenerateObserver& observer,
                                            const std::stop_token& stop);

}  // namespace thunderhead::clouds
