// The test program is also the reader that the tests start. It has misbehaving formats in addition
// to the program's own.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <string_view>

#include "sandbox/reader_main.h"
#include "tests/unit/sandbox/misbehaving_format.h"

int main(int argc, char** argv) {
  using thunderhead::sandbox::FormatsWithMisbehaving;
  if (std::string_view(argv[0]) == thunderhead::sandbox::kReaderName) {
    _exit(thunderhead::sandbox::ReadStormFile(FormatsWithMisbehaving()));
  }
#ifdef __SANITIZE_ADDRESS__
  // These tests wait for a reader's signal, not for AddressSanitizer's report of it.
  const char* options = std::getenv("ASAN_OPTIONS");
  const std::string all =
      std::string(options == nullptr ? "" : options) + ":handle_segv=0:handle_sigbus=0";
  setenv("ASAN_OPTIONS", all.c_str(), 1);
#endif
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
