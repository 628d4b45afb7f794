// The limits that the messages declare for their numbers (thunderhead/v1/limits.proto).
#pragma once

#include <optional>
#include <string>

#include "google/protobuf/descriptor.h"

namespace thunderhead::client {

struct Limits {
  double minimum = 0.0;
  double maximum = 0.0;
  std::optional<double> default_value;
  std::string unit;  // in UCUM notation, "1" for a pure number
  bool logarithmic = false;
  bool whole = false;  // true for an integer field
};

// Returns a field's limits. A field that declares no limits has a minimum and a maximum of 0.
Limits LimitsOf(const google::protobuf::FieldDescriptor& field);

// Returns the limits of a field by name, such as LimitsOf<v1::OrbitCamera>("azimuth_deg"). The
// field must exist.
template <typename Message>
Limits LimitsOf(const std::string& field) {
  return LimitsOf(*Message::descriptor()->FindFieldByName(field));
}

// Returns the nearest value within the limits, rounded if the field is an integer.
double Clamp(double value, const Limits& limits);

}  // namespace thunderhead::client
