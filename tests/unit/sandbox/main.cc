// The tests' program is the reader that they start, as the server's is: with formats that misbehave
// besides the program's own.
#include <gtest/gtest.h>
#include <unistd.h>

#include <string_view>

#include "sandbox/reader_main.h"
#include "tests/unit/sandbox/misbehaving_format.h"

int main(int argc, char** argv) {
  using thunderhead::sandbox::FormatsWithMisbehaving;
  if (argc == 2 && std::string_view(argv[1]) == thunderhead::sandbox::kReaderCommand) {
    _exit(thunderhead::sandbox::ReadUntrustedFile(FormatsWithMisbehaving()));
  }
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
