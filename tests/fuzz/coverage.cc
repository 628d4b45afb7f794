// Coverage for libFuzzer from code that GCC compiled. With -fsanitize-coverage=trace-pc, GCC calls
// __sanitizer_cov_trace_pc once for each basic block. libFuzzer reads the counters in the section
// __libfuzzer_extra_counters in addition to its own. The release's compiler can thus be fuzzed,
// including coroutines, which Debian's Clang 14 does not support.
#include <cstddef>
#include <cstdint>

namespace {

constexpr std::size_t kCounters = 1 << 16;

[[gnu::section("__libfuzzer_extra_counters"), gnu::used]] std::uint8_t counters[kCounters];

}  // namespace

extern "C" {

__attribute__((no_sanitize_coverage)) void __sanitizer_cov_trace_pc() {
  const auto place = reinterpret_cast<std::uintptr_t>(__builtin_return_address(0));
  ++counters[(place * 0x9e3779b97f4a7c15U) >> 48U];
}

// GCC calls these functions for comparisons of floating-point numbers; libFuzzer does not define
// them.
__attribute__((no_sanitize_coverage)) void __sanitizer_cov_trace_cmpf(float, float) {}
__attribute__((no_sanitize_coverage)) void __sanitizer_cov_trace_cmpd(double, double) {}

}  // extern "C"
