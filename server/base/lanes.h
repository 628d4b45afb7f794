// SIMD numbers. A formula is written once and is instantiated for eight lanes at once or for a
// single number. Functions marked THUNDERHEAD_IN_LANES are inlined, so they use the instruction set
// that their caller may use.
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

// The integer type with as many lanes as `Floats`.
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

// Sets all lanes to the same number.
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
// Rounds towards zero.
THUNDERHEAD_IN_LANES void Convert(const EightFloats& from, EightIntegers* to) {
  *to = __builtin_convertvector(from, EightIntegers);
}

// Calls `function` with each lane's values and stores the result in the lane.
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

// Loads the number at `bytes` + `stride` * `index`.
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
