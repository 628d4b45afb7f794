// Man's cloud generator: noise inside a union of ellipsoids (eq. 1, 8-10) as liquid water on a
// grid. The same parameters give the same bits on every machine.
#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "absl/status/statusor.h"
#include "clouds/cloud_shape.h"

namespace thunderhead::clouds {

// A function that is called between slices with the share done.
using GenerateObserver = std::function<void(double share)>;

// Returns INVALID_ARGUMENT if a parameter is out of range. The message names the parameter.
absl::Status CheckShape(const CloudShape& shape);

// Returns the liquid water (kg/m3) of every cell, x fastest. N is the noise and Q is the largest of
// the ellipsoids' modulations at a cell's centre. By eq. 10, D = d N Q where N Q >= t, and 0
// elsewhere. (The paper's text uses Q for the product of both.) Fails if a parameter is out of
// range or no cell holds any cloud. Returns CANCELLED if `stop` asks to stop.
absl::StatusOr<std::vector<float>> Generate(const CloudShape& shape,
                                            const GenerateObserver& observer,
                                            const std::stop_token& stop);

}  // namespace thunderhead::clouds
