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
  std::string unit;  // as UCUM writes it, "1" for a pure number
  bool logarithmic = false;
  bool whole = false;  // an integer field
};

// All zero for a field that declares none.
Limits LimitsOf(const google::protobuf::FieldDescriptor& field);

// LimitsOf<v1::OrbitCamera>("azimuth_deg"); the field must exist.
template <typename Message>
Limits LimitsOf(const std::string& field) {
  return LimitsOf(*Message::descriptor()->FindFieldByName(field));
}

// The nearest value within the limits; whole where the field is.
double Clamp(double value, const Limits& limits);

}  // namespace thunderhead::client
