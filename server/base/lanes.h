// Numbers in lanes: eight that the processor computes with at once, or one, so that a formula is
// written once for both. With THUNDERHEAD_IN_LANES functions are inlined, and use what the function
// that calls them may use of the processor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace thunderhead::base {

// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): an attribute has no other name.
#define THUNDERHEAD_IN_LANES [[gnu::always_inline]] inline

inline constexpr std::size_t kLanes = 8;

using EightFloats = float __attribute__((vector_size(4 * kLanes)));
using EightIntegers = std::int32_t __attribute__((vector_size(4 * kLanes)));

// The integers in as many lanes.
template <typename Floats>
struct IntegersOf;
template <>
struct IntegersOf<float> {
  using Type = std::int32_t;
};
template <>
struct IntegersOf<EightFloats> {
  using Type = EightIntegers;
};
template <typename Floats>
using Integers = typename IntegersOf<Floats>::Type;

// The same number in all lanes.
template <typename Lanes, typename Number>
THUNDERHEAD_IN_LANES void SetAll(Number number, Lanes* lanes) {
  *lanes = Lanes{} + number;
}

THUNDERHEAD_IN_LANES void Convert(const std::int32_t& from, float* to) {
  *to = static_cast<float>(from);
}
THUNDERHEAD_IN_LANES void Convert(const float& from, std::int32_t* to) {
  *to = static_cast<std::int32_t>(from);
}
THUNDERHEAD_IN_LANES void Convert(const EightIntegers& from, EightFloats* to) {
  *to = __builtin_convertvector(from, EightFloats);
}
// Towards zero.
THUNDERHEAD_IN_LANES void Convert(const EightFloats& from, EightIntegers* to) {
  *to = __builtin_convertvector(from, EightIntegers);
}

// Stores function(values in the lane...) in each lane.
template <typename Function, typename... Values>
THUNDERHEAD_IN_LANES void ForLanes(const Function& function, float* result,
                                   const Values&... values) {
  *result = function(values...);
}
template <typename Function, typename... Values>
THUNDERHEAD_IN_LANES void ForLanes(const Function& function, EightFloats* result,
                                   const Values&... values) {
  EightFloats results;
  for (std::size_t i = 0; i < kLanes; ++i) results[i] = function(values[i]...);
  *result = results;
}

THUNDERHEAD_IN_LANES bool AnyAbove(float least, const float& value) { return value > least; }
THUNDERHEAD_IN_LANES bool AnyAbove(float least, const EightFloats& values) {
  const EightIntegers above = values > least;
  std::int32_t any = 0;
  for (std::size_t i = 0; i < kLanes; ++i) any |= above[i];
  return any != 0;
}

// The number at `bytes` + `stride` `index`.
template <typename Number>
THUNDERHEAD_IN_LANES void Load(const void* bytes, std::ptrdiff_t stride, const std::int32_t& index,
                               std::int32_t* numbers) {
  Number number = 0;
  std::memcpy(&number, static_cast<const char*>(bytes) + stride * index, sizeof(number));
  *numbers = static_cast<std::int32_t>(number);
}
template <typename Number>
THUNDERHEAD_IN_LANES void Load(const void* bytes, std::ptrdiff_t stride, const EightIntegers& index,
                               EightIntegers* numbers) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    std::int32_t number = 0;
    Load<Number>(bytes, stride, index[i], &number);
    (*numbers)[i] = number;
  }
}

}  // namespace thunderhead::base
