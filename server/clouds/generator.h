// Man's cloud generator: noise inside a union of ellipsoids (eq. 1, 8-10) as liquid water on a
// grid. The same bits for the same parameters on every machine.
#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "absl/status/statusor.h"
#include "clouds/cloud_shape.h"

namespace thunderhead::clouds {

// Called between slices with the share done.
using GenerateObserver = std::function<void(double share)>;

// INVALID_ARGUMENT if a parameter is out of range; the message names it.
absl::Status CheckShape(const CloudShape& shape);

// Liquid water (kg/m3) in every cell, x fastest. With N the noise and Q the largest of the
// ellipsoids' modulations at a cell's middle, D = d N Q where N Q >= t and 0 elsewhere: eq. 10
// (where the paper's text uses Q for the product of both). Fails if a parameter is out of range or
// no cell holds any cloud; CANCELLED if `stop` asks to stop.
absl::StatusOr<std::vector<float>> Generate(const CloudShape& shape,
                                            const GenerateObserver& observer,
                                            const std::stop_token& stop);

}  // namespace thunderhead::clouds
