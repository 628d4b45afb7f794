#include "thunderhead_client/limits.h"

#include <algorithm>
#include <cmath>

#include "thunderhead/v1/limits.pb.h"

namespace thunderhead::client {

using google::protobuf::FieldDescriptor;

Limits LimitsOf(const FieldDescriptor& field) {
  const v1::NumberLimits& number = field.options().GetExtension(v1::number);
  Limits limits;
  limits.minimum = number.minimum();
  limits.maximum = number.maximum();
  if (number.has_default_value()) limits.default_value = number.default_value();
  limits.unit = number.unit();
  limits.logarithmic = number.logarithmic();
  limits.whole = field.cpp_type() != FieldDescriptor::CPPTYPE_FLOAT &&
                 field.cpp_type() != FieldDescriptor::CPPTYPE_DOUBLE;
  return limits;
}

double Clamp(double value, const Limits& limits) {
  if (std::isnan(value)) return limits.default_value.value_or(limits.minimum);
  return std::clamp(limits.whole ? std::round(value) : value, limits.minimum, limits.maximum);
}

}  // namespace thunderhead::client
