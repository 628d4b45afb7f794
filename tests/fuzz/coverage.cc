// Coverage for libFuzzer from code that GCC compiled: -fsanitize-coverage=trace-pc calls this once
// for each basic block, and libFuzzer reads counters of this section besides its own. So the very
// compiler of the release is fuzzed, with the coroutines that Debian's Clang 14 does not know.
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

// GCC's comparisons of real numbers, which libFuzzer does not know.
__attribute__((no_sanitize_coverage)) void __sanitizer_cov_trace_cmpf(float, float) {}
__attribute__((no_sanitize_coverage)) void __sanitizer_cov_trace_cmpd(double, double) {}

}  // extern "C"
