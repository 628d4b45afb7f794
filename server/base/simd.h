// SIMD numbers. A formula is written once and is instantiated for eight numbers at once or for
// a single number. Functions marked THUNDERHEAD_SIMD are inlined, so they use the instruction set
// that their caller may use.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace thunderhead::base {

// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): an attribute has no other name.
#define THUNDERHEAD_SIMD [[gnu::always_inline]] inline

inline constexpr std::size_t kSimdWidth = 8;

using EightFloats = float __attribute__((vector_size(4 * kSimdWidth)));
using EightIntegers = std::int32_t __attribute__((vector_size(4 * kSimdWidth)));

// The integer type with as many numbers as `Floats`.
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

// Sets all elements of `simd` to the same number.
template <typename Simd, typename Number>
THUNDERHEAD_SIMD void SetAll(Number number, Simd* simd) {
  *simd = Simd{} + number;
}

THUNDERHEAD_SIMD void Convert(const std::int32_t& from, float* to) {
  *to = static_cast<float>(from);
}
THUNDERHEAD_SIMD void Convert(const float& from, std::int32_t* to) {
  *to = static_cast<std::int32_t>(from);
}
THUNDERHEAD_SIMD void Convert(const EightIntegers& from, EightFloats* to) {
  *to = __builtin_convertvector(from, EightFloats);
}
// Rounds towards zero.
THUNDERHEAD_SIMD void Convert(const EightFloats& from, EightIntegers* to) {
  *to = __builtin_convertvector(from, EightIntegers);
}

// Calls `function` with the values of each index and stores the result at that index.
template <typename Function, typename... Values>
THUNDERHEAD_SIMD void ForEach(const Function& function, float* result, const Values&... values) {
  *result = function(values...);
}
template <typename Function, typename... Values>
THUNDERHEAD_SIMD void ForEach(const Function& function, EightFloats* result,
                              const Values&... values) {
  EightFloats results;
  for (std::size_t i = 0; i < kSimdWidth; ++i) results[i] = function(values[i]...);
  *result = results;
}

THUNDERHEAD_SIMD bool AnyAbove(float least, const float& value) { return value > least; }
THUNDERHEAD_SIMD bool AnyAbove(float least, const EightFloats& values) {
  const EightIntegers above = values > least;
  std::int32_t any = 0;
  for (std::size_t i = 0; i < kSimdWidth; ++i) any |= above[i];
  return any != 0;
}

// Loads the number at `bytes` + `stride` * `index`.
template <typename Number>
THUNDERHEAD_SIMD void Load(const void* bytes, std::ptrdiff_t stride, const std::int32_t& index,
                           std::int32_t* numbers) {
  Number number = 0;
  std::memcpy(&number, static_cast<const char*>(bytes) + stride * index, sizeof(number));
  *numbers = static_cast<std::int32_t>(number);
}
template <typename Number>
THUNDERHEAD_SIMD void Load(const void* bytes, std::ptrdiff_t stride, const EightIntegers& index,
                           EightIntegers* numbers) {
  for (std::size_t i = 0; i < kSimdWidth; ++i) {
    std::int32_t number = 0;
    Load<Number>(bytes, stride, index[i], &number);
    (*numbers)[i] = number;
  }
}

}  // namespace thunderhead::base
